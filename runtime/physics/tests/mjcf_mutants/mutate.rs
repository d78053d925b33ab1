//! Ways to break a file.

use super::seeds;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A model's files: the main one, and those beside it.
pub struct Files {
    pub main: String,
    pub others: Vec<(String, Vec<u8>)>,
}

type Random = Pcg64Mcg;
type Mutation = fn(&mut Random, String) -> String;

/// Each takes a text and gives it back broken.
const MUTATIONS: [Mutation; 24] = [
    flip_bytes,
    cut,
    repeat,
    truncate,
    evil_number,
    evil_number,
    evil_number,
    other_number,
    other_number,
    other_number,
    other_number,
    other_number,
    other_number,
    swap_values,
    swap_values,
    rename_attribute,
    one_name_for_all,
    nest,
    copy_endlessly,
    without_mass,
    endless_list,
    classes_in_circles,
    entities,
    move_element,
];

/// Numbers that break what trusts them.
const EVIL: [&str; 24] = [
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e30",
    "-1e30",
    "1e29",
    "1e-320",
    "0",
    "-0",
    "-1",
    "1",
    "1e-15",
    "1e15",
    "999999999",
    "4294967296",
    "-2147483649",
    "0x7f",
    "1.5",
    "",
    " ",
    "1 2 3 4 5 6 7",
    "true",
];

/// Attributes and elements to put where others were.
const WORDS: [&str; 22] = [
    "pos",
    "quat",
    "euler",
    "size",
    "type",
    "class",
    "childclass",
    "name",
    "mass",
    "density",
    "range",
    "ref",
    "joint1",
    "site",
    "tendon",
    "gear",
    "lengthrange",
    "file",
    "mesh",
    "group",
    "fromto",
    "solimp",
];

/// The broken file with this number.
pub fn files(number: u64) -> Files {
    let mut random = Random::seed_from_u64(number ^ 0x6d73_6b21);
    let (_, seed) = seeds::SEEDS[pick(&mut random, seeds::SEEDS.len())];
    let mut others = seeds::others(seed);
    let mut main = seed.to_owned();
    for _ in 0..1 + pick(&mut random, 3) {
        main = MUTATIONS[pick(&mut random, MUTATIONS.len())](&mut random, main);
    }
    break_others(&mut random, &mut others);
    Files { main, others }
}

fn pick(random: &mut Random, count: usize) -> usize {
    random.random_range(0..count.max(1))
}

/// A place in the text between two characters.
fn place(random: &mut Random, text: &str) -> usize {
    let mut at = pick(random, text.len() + 1);
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// Two places in the text, at most so far apart.
fn span(random: &mut Random, text: &str, most: usize) -> (usize, usize) {
    let start = place(random, text);
    let mut end = (start + pick(random, most)).min(text.len());
    while !text.is_char_boundary(end) {
        end += 1;
    }
    (start, end)
}

fn flip_bytes(random: &mut Random, text: String) -> String {
    let mut bytes = text.into_bytes();
    for _ in 0..1 + pick(random, 8) {
        let at = pick(random, bytes.len());
        if let Some(byte) = bytes.get_mut(at) {
            *byte ^= 1 << (random.next_u32() % 8);
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn cut(random: &mut Random, mut text: String) -> String {
    let (start, end) = span(random, &text, 200);
    text.replace_range(start..end, "");
    text
}

fn repeat(random: &mut Random, mut text: String) -> String {
    let (start, end) = span(random, &text, 300);
    let piece = text[start..end].repeat(1 + pick(random, 50));
    let at = place(random, &text);
    text.insert_str(at, &piece);
    text
}

fn truncate(random: &mut Random, mut text: String) -> String {
    let at = place(random, &text);
    text.truncate(at);
    text
}

/// Where the values of attributes stand.
fn values(text: &str) -> Vec<(usize, usize)> {
    let starts = text.match_indices("=\"").map(|(at, _)| at + 2);
    starts.filter_map(|start| Some((start, start + text[start..].find('"')?))).collect()
}

fn evil_number(random: &mut Random, text: String) -> String {
    let evil = EVIL[pick(random, EVIL.len())];
    replace_number(random, text, |_, _| evil.to_owned())
}

/// A number made larger, smaller or negative, by anything between a little and twenty orders of magnitude.
fn other_number(random: &mut Random, text: String) -> String {
    replace_number(random, text, |random, word| match word.parse::<f64>() {
        Ok(number) => {
            let factor = 10_f64.powf(random.random_range(-4.0..4.0_f64).powi(3) / 3.0);
            let sign = if random.random_bool(0.2) { -1.0 } else { 1.0 };
            format!("{:e}", (number + f64::from(u8::from(number == 0.0))) * factor * sign)
        }
        Err(_) => word.to_owned(),
    })
}

/// Puts something else in the place of one word of one attribute.
fn replace_number(random: &mut Random, mut text: String, other: impl Fn(&mut Random, &str) -> String) -> String {
    let values = values(&text);
    if values.is_empty() {
        return text;
    }
    let (start, end) = values[pick(random, values.len())];
    let words: Vec<String> = text[start..end].split(' ').map(str::to_owned).collect();
    let victim = pick(random, words.len());
    let found = other(random, &words[victim]);
    let changed: Vec<&str> =
        words.iter().enumerate().map(|(index, word)| if index == victim { &found } else { word.as_str() }).collect();
    text.replace_range(start..end, &changed.join(" "));
    text
}

fn swap_values(random: &mut Random, mut text: String) -> String {
    let values = values(&text);
    if values.len() < 2 {
        return text;
    }
    let mut pair = [values[pick(random, values.len())], values[pick(random, values.len())]];
    pair.sort_unstable();
    let [(a, b), (c, d)] = pair;
    if b <= c {
        let (first, second) = (text[a..b].to_owned(), text[c..d].to_owned());
        text.replace_range(c..d, &first);
        text.replace_range(a..b, &second);
    }
    text
}

fn rename_attribute(random: &mut Random, mut text: String) -> String {
    let values = values(&text);
    if values.is_empty() {
        return text;
    }
    let (start, _) = values[pick(random, values.len())];
    let name = text[..start - 2].rfind(|character: char| !character.is_alphanumeric()).map_or(0, |at| at + 1);
    text.replace_range(name..start - 2, WORDS[pick(random, WORDS.len())]);
    text
}

/// Two elements, or all, with one name.
fn one_name_for_all(random: &mut Random, text: String) -> String {
    let names: Vec<(usize, usize)> =
        values(&text).into_iter().filter(|(start, _)| text[..*start].ends_with(" name=\"")).collect();
    let all = random.random_bool(0.3);
    let mut result = text.clone();
    for (start, end) in names.into_iter().rev() {
        if all || random.random_bool(0.1) {
            result.replace_range(start..end, "same");
        }
    }
    result
}

/// Wraps the inside of the world in many elements.
fn nest(random: &mut Random, text: String) -> String {
    let depth = [3, 40, 200, 300, 5_000][pick(random, 5)];
    let (open, close) = [
        ("<body>", "</body>"),
        ("<frame pos=\"0 0 1\" euler=\"1 2 3\">", "</frame>"),
        ("<body><joint/><geom size=\"0.1\"/>", "</body>"),
        ("<replicate count=\"1\">", "</replicate>"),
        ("<body mocap=\"true\">", "</body>"),
    ][pick(random, 5)];
    text.replace("<worldbody>", &format!("<worldbody>{}", open.repeat(depth)))
        .replace("</worldbody>", &format!("{}</worldbody>", close.repeat(depth)))
}

/// Copies a body more often than there is room for, or nearly.
fn copy_endlessly(random: &mut Random, text: String) -> String {
    let count = ["0", "1", "3", "50", "1000", "99999", "1000000", "9999999999", "-1", "x"][pick(random, 10)];
    let open = format!("<replicate count=\"{count}\" offset=\"0 0 1\" euler=\"0 0 1\"><body");
    let text = text.replacen("<body", &open, 1);
    match text.rfind("</worldbody>") {
        Some(at) => format!("{}</replicate>{}", &text[..at], &text[at..]),
        None => text,
    }
}

fn without_mass(random: &mut Random, text: String) -> String {
    let zero = ["0", "1e-16", "-1", "1e-300", "1e29"][pick(random, 5)];
    let text = text.replace("<geom ", &format!("<geom mass=\"{zero}\" "));
    text.replace("mass=\"1\"", &format!("mass=\"{zero}\"")).replace("diaginertia=\"", "diaginertia=\"0 ")
}

fn endless_list(random: &mut Random, mut text: String) -> String {
    let values = values(&text);
    if values.is_empty() {
        return text;
    }
    let (_, end) = values[pick(random, values.len())];
    let piece = [" 1", " 1e30", "x", " -1 nan", "&lt;"][pick(random, 5)];
    text.insert_str(end, &piece.repeat(1 + pick(random, 20_000)));
    text
}

fn classes_in_circles(random: &mut Random, text: String) -> String {
    let section = [
        "<default class=\"main\"><default class=\"main\"/></default>",
        "<default><default class=\"a\"><default class=\"a\"/></default></default>",
        "<default><default class=\"a\"><geom class=\"a\"/></default></default>",
        "<default><geom class=\"none\" type=\"mesh\" mesh=\"m\"/></default>",
        "<default class=\"other\"/>",
        "<default><joint type=\"free\"/></default>",
        "<default><geom fromto=\"0 0 0 0 0 0\"/></default>",
    ][pick(random, 7)];
    text.replace("<worldbody>", &format!("{section}<worldbody>"))
}

fn entities(random: &mut Random, text: String) -> String {
    let laughs: String = (1..24).map(|n| format!("<!ENTITY e{n} \"&e{};&e{};&e{};\">", n - 1, n - 1, n - 1)).collect();
    let head = [
        format!("<!DOCTYPE m [<!ENTITY e0 \"ha\">{laughs}]>"),
        "<!DOCTYPE m [<!ENTITY e0 SYSTEM \"/dev/zero\">]>".to_owned(),
        "<!DOCTYPE m [<!ENTITY e0 \"&e0;\">]>".to_owned(),
        "<?xml version=\"1.0\" encoding=\"utf-16\"?>".to_owned(),
        "\u{feff}".to_owned(),
    ];
    let used = ["&e0;", "&e3;", "&e23;", "&#0;", "&#x110000;", "&nothing;"][pick(random, 6)];
    let mut text = text;
    if let Some((start, _)) = values(&text).first().copied() {
        text.insert_str(start, used);
    }
    format!("{}{text}", head[pick(random, head.len())])
}

/// Puts a whole line somewhere else.
fn move_element(random: &mut Random, text: String) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    if lines.is_empty() {
        return text;
    }
    let line = lines.remove(pick(random, lines.len()));
    let to = pick(random, lines.len() + 1);
    lines.insert(to, line);
    if random.random_bool(0.5) {
        lines.insert(to, line);
    }
    lines.join("\n")
}

/// Breaks the files beside the main one: circles, rubbish, sizes that lie.
fn break_others(random: &mut Random, others: &mut [(String, Vec<u8>)]) {
    for (name, contents) in others {
        match (name.ends_with(".xml"), pick(random, 6)) {
            (true, 0) => *contents = b"<mujoco><include file=\"main.xml\"/></mujoco>".to_vec(),
            (true, 1) => *contents = b"<mujoco><include file=\"limb.xml\"/></mujoco>".to_vec(),
            (true, 2) => *contents = evil_number(random, String::from_utf8_lossy(contents).into_owned()).into_bytes(),
            (true, 3) => *contents = flip_bytes(random, String::from_utf8_lossy(contents).into_owned()).into_bytes(),
            // The number of triangles that the file declares.
            (false, 0) => contents[80..84].copy_from_slice(&u32::MAX.to_le_bytes()),
            (false, 1) => contents[80..84].copy_from_slice(&[0; 4]),
            (false, 2) => contents.truncate(100),
            (false, 3) => {
                for _ in 0..20 {
                    let at = 84 + pick(random, contents.len() - 84);
                    contents[at] = random.next_u32() as u8;
                }
            }
            _ => {}
        }
    }
}
