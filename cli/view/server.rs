//! A server for one reader on this machine: GET over HTTP/1.1, on the loopback interface alone.
//!
//! What a request must have: the token of this server as the first part of its path, which other programs and pages do not know; the
//! server's own name as `Host`, so that a page elsewhere cannot reach it through a name of its own (DNS rebinding); no body. Connections are
//! few, and each ends within a time, whatever its reader does.

use crate::error::{Context, Error};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Connections at a time; further ones are refused.
const MOST: usize = 16;
/// Bytes of a request at most, and header fields.
const LARGEST: usize = 8192;
const FIELDS: usize = 64;
/// How long a reader may take to send its request, and to take the answer.
const ASKING: Duration = Duration::from_secs(5);
const TAKING: Duration = Duration::from_secs(20);
/// How often a wait looks whether the server is to stop.
const TICK: Duration = Duration::from_millis(50);

/// What is sent back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answer {
    /// Status of HTTP, with its words.
    pub status: &'static str,
    /// Media type.
    pub kind: &'static str,
    /// Content.
    pub body: Vec<u8>,
}

impl Answer {
    /// Content of a type.
    pub fn of(kind: &'static str, body: Vec<u8>) -> Self {
        Self { status: "200 OK", kind, body }
    }

    /// A sentence under a status.
    pub fn text(status: &'static str, text: impl Into<String>) -> Self {
        Self { status, kind: "text/plain; charset=utf-8", body: text.into().into_bytes() }
    }
}

/// A listening server.
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    token: String,
}

impl Server {
    /// Listens on a port of the loopback interface; 0 for any that is free.
    ///
    /// # Errors
    /// A port that is in use, or no random numbers.
    pub fn open(port: u16) -> Result<Self, Error> {
        let cannot = || format!("cannot listen on port {port} of this machine");
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).context(cannot)?;
        listener.set_nonblocking(true).context(cannot)?;
        let address = listener.local_addr().context(cannot)?;
        let mut secret = [0; 16];
        getrandom::fill(&mut secret).map_err(|error| Error::new(format!("there are no random numbers for a token: {error}")))?;
        let token = secret.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { listener, address, token })
    }

    /// The address to open.
    pub fn url(&self) -> String {
        format!("http://{}/{}/", self.address, self.token)
    }

    /// Answers until `stop` holds. `answer` gets the path behind the token.
    ///
    /// # Errors
    /// The operating system ends the listening.
    pub fn serve(&self, stop: &(dyn Fn() -> bool + Sync), answer: &(dyn Fn(&str) -> Answer + Sync)) -> io::Result<()> {
        let open = AtomicUsize::new(0);
        thread::scope(|scope| {
            while !stop() {
                let stream = match self.listener.accept() {
                    Ok((stream, _)) => stream,
                    Err(error) if is_of_one_connection(&error) => {
                        thread::sleep(TICK);
                        continue;
                    }
                    Err(error) => return Err(error),
                };
                if open.load(Ordering::Relaxed) >= MOST {
                    continue;
                }
                open.fetch_add(1, Ordering::Relaxed);
                let open = &open;
                scope.spawn(move || {
                    // A reader that has gone away is no failure of the server.
                    let _ = self.connection(stream, stop, answer);
                    open.fetch_sub(1, Ordering::Relaxed);
                });
            }
            Ok(())
        })
    }

    fn connection(
        &self,
        mut stream: TcpStream,
        stop: &(dyn Fn() -> bool + Sync),
        answer: &(dyn Fn(&str) -> Answer + Sync),
    ) -> io::Result<()> {
        stream.set_nonblocking(false)?;
        stream.set_read_timeout(Some(TICK))?;
        stream.set_write_timeout(Some(TICK))?;
        let head = receive(&mut stream, stop)?;
        let reply = match head.and_then(|head| self.path(&head)) {
            Ok(path) => answer(&path),
            Err(refusal) => refusal,
        };
        send(&mut stream, &reply, stop)
    }

    /// The path behind the token of a request that may be answered.
    fn path(&self, head: &[u8]) -> Result<String, Answer> {
        let mut fields = [httparse::EMPTY_HEADER; FIELDS];
        let mut request = httparse::Request::new(&mut fields);
        let whole = request.parse(head).is_ok_and(|status| status.is_complete());
        let (Some(method), Some(target), true) = (request.method, request.path, whole) else {
            return Err(Answer::text("400 Bad Request", "expected a request of HTTP/1.1\n"));
        };
        if method != "GET" {
            return Err(Answer::text("405 Method Not Allowed", "expected GET\n"));
        }
        let named = |name: &str| -> Vec<&[u8]> {
            request.headers.iter().filter(|field| field.name.eq_ignore_ascii_case(name)).map(|field| field.value).collect()
        };
        let own = [self.address.to_string(), format!("localhost:{}", self.address.port())];
        let [host] = named("Host")[..] else {
            return Err(Answer::text("400 Bad Request", "expected one field `Host`\n"));
        };
        if !own.iter().any(|name| name.as_bytes().eq_ignore_ascii_case(host)) {
            return Err(Answer::text("421 Misdirected Request", "this server answers under its own name alone\n"));
        }
        if !named("Transfer-Encoding").is_empty() || named("Content-Length").iter().any(|length| *length != b"0") {
            return Err(Answer::text("400 Bad Request", "expected a request without a body\n"));
        }
        let path = target.split(['?', '#']).next().unwrap_or_default();
        let parts = path.strip_prefix('/').and_then(|path| path.split_once('/'));
        match parts.filter(|(token, _)| same(token.as_bytes(), self.token.as_bytes())) {
            Some((_, rest)) => Ok(rest.to_owned()),
            None => Err(Answer::text("403 Forbidden", "open the address that `msk view` printed\n")),
        }
    }
}

/// Errors after which the next connection may still come: nobody is there, or the one that came is gone, or there are too many files.
fn is_of_one_connection(error: &io::Error) -> bool {
    let again = [ErrorKind::WouldBlock, ErrorKind::Interrupted, ErrorKind::ConnectionAborted, ErrorKind::ConnectionReset];
    again.contains(&error.kind()) || error.raw_os_error().is_some()
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |different, (a, b)| different | (a ^ b)) == 0
}

/// The head of a request, or why there is none.
fn receive(stream: &mut TcpStream, stop: &dyn Fn() -> bool) -> io::Result<Result<Vec<u8>, Answer>> {
    let begin = Instant::now();
    let (mut head, mut part) = (Vec::new(), [0; 1024]);
    loop {
        match stream.read(&mut part) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => head.extend(&part[..count]),
            Err(error) if is_pause(&error) => {}
            Err(error) => return Err(error),
        }
        if head.windows(4).any(|end| end == b"\r\n\r\n") {
            return Ok(Ok(head));
        }
        if head.len() > LARGEST {
            return Ok(Err(Answer::text("431 Request Header Fields Too Large", "the request is too long\n")));
        }
        if begin.elapsed() > ASKING || stop() {
            return Ok(Err(Answer::text("408 Request Timeout", "the request did not come in time\n")));
        }
    }
}

fn send(stream: &mut TcpStream, answer: &Answer, stop: &dyn Fn() -> bool) -> io::Result<()> {
    let Answer { status, kind, body } = answer;
    // The page may ask this server and nothing else; nobody may frame it but itself.
    let policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                  connect-src 'self'; frame-src 'self'; frame-ancestors 'self'; base-uri 'none'; form-action 'none'";
    let allow = if status.starts_with("405") { "Allow: GET\r\n" } else { "" };
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n{allow}Connection: close\r\nCache-Control: no-store\r\n\
         Content-Security-Policy: {policy}\r\nCross-Origin-Resource-Policy: same-origin\r\nReferrer-Policy: no-referrer\r\n\
         X-Content-Type-Options: nosniff\r\n\r\n",
        body.len()
    );
    let begin = Instant::now();
    for mut rest in [head.as_bytes(), body] {
        while !rest.is_empty() {
            match stream.write(rest) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => rest = &rest[count..],
                Err(error) if is_pause(&error) && begin.elapsed() < TAKING && !stop() => {}
                Err(error) => return Err(error),
            }
        }
    }
    stream.flush()
}

/// Whether a read or write only has to be tried again.
fn is_pause(error: &io::Error) -> bool {
    [ErrorKind::WouldBlock, ErrorKind::TimedOut, ErrorKind::Interrupted].contains(&error.kind())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicBool;

    /// What comes back for bytes that are sent to a server; nothing for a connection that was closed.
    fn talk(server: &Server, request: &str) -> String {
        let mut stream = TcpStream::connect(server.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        stream.write_all(request.replace("TOKEN", &server.token).as_bytes()).unwrap();
        let mut text = Vec::new();
        let _ = stream.read_to_end(&mut text);
        String::from_utf8(text).unwrap()
    }

    fn serving(check: impl FnOnce(&Server)) {
        let server = Server::open(0).unwrap();
        let over = AtomicBool::new(false);
        thread::scope(|scope| {
            let (server, over) = (&server, &over);
            let echo = |path: &str| Answer::of("text/plain", path.as_bytes().to_vec());
            let served = scope.spawn(move || server.serve(&|| over.load(Ordering::Relaxed), &echo));
            check(server);
            over.store(true, Ordering::Relaxed);
            served.join().unwrap().unwrap();
        });
    }

    fn get(server: &Server, path: &str) -> String {
        format!("GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n", server.address)
    }

    #[test]
    fn only_what_knows_the_token_is_answered() {
        serving(|server| {
            let good = talk(server, &get(server, "/TOKEN/some?when=now"));
            assert!(good.starts_with("HTTP/1.1 200 OK\r\n") && good.ends_with("\r\n\r\nsome"), "{good}");
            assert!(good.contains("connect-src 'self'") && good.contains("nosniff") && good.contains("no-store"));
            for path in ["/", "/some", "/0123/some", "//TOKEN/some", "/TOKE/some", "/TOKEN", "*", "http://elsewhere/TOKEN/"] {
                assert!(talk(server, &get(server, path)).starts_with("HTTP/1.1 403 "), "{path}");
            }
            assert_ne!(server.token, Server::open(0).unwrap().token);
        });
    }

    #[test]
    fn other_hosts_methods_and_nonsense_are_refused() {
        serving(|server| {
            let host = format!("Host: {}\r\n", server.address);
            let here = format!("Host: localhost:{}\r\n", server.address.port());
            let cases = [
                (format!("GET /TOKEN/ HTTP/1.1\r\n{here}\r\n"), "200"),
                ("GET /TOKEN/ HTTP/1.1\r\nHost: evil.example\r\n\r\n".into(), "421"),
                (format!("GET /TOKEN/ HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", server.address.port().wrapping_add(1)), "421"),
                ("GET /TOKEN/ HTTP/1.1\r\n\r\n".into(), "400"),
                (format!("GET /TOKEN/ HTTP/1.1\r\n{host}{host}\r\n"), "400"),
                (format!("GET /TOKEN/ HTTP/1.1\r\n{host}Content-Length: 4\r\n\r\nbody"), "400"),
                (format!("GET /TOKEN/ HTTP/1.1\r\n{host}Transfer-Encoding: chunked\r\n\r\n"), "400"),
                (format!("POST /TOKEN/ HTTP/1.1\r\n{host}\r\n"), "405"),
                (format!("OPTIONS /TOKEN/ HTTP/1.1\r\n{host}\r\n"), "405"),
                (format!("HEAD /TOKEN/ HTTP/1.1\r\n{host}\r\n"), "405"),
                ("nonsense\r\n\r\n".into(), "400"),
                ("\0\r\n\r\n".into(), "400"),
                (format!("GET /TOKEN/ HTTP/1.1\r\n{host}{}\r\n", "a: b\r\n".repeat(100)), "400"),
                (format!("GET /{} HTTP/1.1\r\n", "x".repeat(LARGEST + 1100)), "431"),
            ];
            for (request, status) in cases {
                let found = talk(server, &request);
                assert!(found.starts_with(&format!("HTTP/1.1 {status} ")), "{request:?}: {found:?}");
            }
        });
    }

    #[test]
    fn readers_that_stall_or_vanish_stop_nothing() {
        let begin = Instant::now();
        serving(|server| {
            // All places are taken by readers that never say anything: until their time is over others are refused.
            let silent: Vec<TcpStream> = (0..MOST).map(|_| TcpStream::connect(server.address).unwrap()).collect();
            let half: Vec<TcpStream> = (0..3)
                .map(|_| {
                    let mut stream = TcpStream::connect(server.address).unwrap();
                    let _ = stream.write_all(b"GET /");
                    stream
                })
                .collect();
            drop(half);
            while !talk(server, &get(server, "/TOKEN/x")).starts_with("HTTP/1.1 200") {
                assert!(begin.elapsed() < Duration::from_secs(60));
                thread::sleep(TICK);
            }
            drop(silent);
        });
    }
}
