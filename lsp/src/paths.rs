//! Between the addresses of the protocol and the paths of files.

use lsp_types::Uri;
use msk_compiler::files::plain;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use url::Url;

/// The path of an address. What is no file (`untitled:Untitled-1`) is a path of its own that no file has.
pub fn path(uri: &Uri) -> PathBuf {
    let file = Url::parse(uri.as_str()).ok().filter(|url| url.scheme() == "file").and_then(|url| url.to_file_path().ok());
    file.map_or_else(|| PathBuf::from(uri.as_str()), |path| plain(&path))
}

/// The address of a path; none of what is embedded in the program.
pub fn uri(path: &Path) -> Option<Uri> {
    if path.is_absolute() {
        return Uri::from_str(Url::from_file_path(path).ok()?.as_str()).ok();
    }
    let text = path.to_str()?;
    text.split_once(':').filter(|(scheme, _)| scheme.len() > 1)?;
    Uri::from_str(text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_paths_lead_to_each_other() {
        let address = Uri::from_str("file:///home/a%20b/stand.msk").unwrap();
        let there = path(&address);
        assert_eq!(there, Path::new("/home/a b/stand.msk"));
        assert_eq!(uri(&there), Some(address));
        assert_eq!(path(&Uri::from_str("file:///a/b/../c.msk").unwrap()), Path::new("/a/c.msk"));
    }

    #[test]
    fn a_text_without_a_file_keeps_its_address() {
        let address = Uri::from_str("untitled:Untitled-1").unwrap();
        assert_eq!(uri(&path(&address)), Some(address));
        assert_eq!(uri(Path::new("<built-in>/bodies/human.msk")), None);
    }
}
