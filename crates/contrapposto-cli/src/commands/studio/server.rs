//! Answers requests for the files of the page.
//!
//! The server knows GET and HEAD of files below the page's folder, answers requests whose `Host` is this machine, and nothing else. A request has so many
//! seconds in all, and so many are answered at once.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest head of a request, bytes.
const MOST_HEAD: u64 = 16 << 10;
/// Longest time from a connection to the end of its answer, s.
const PATIENCE: Duration = Duration::from_secs(10);
/// Connections that are served at a time: a browser opens six to a server.
const THREADS: usize = 16;
/// Content policy: lists all that the page and its workers may load. A worker takes the policy of its own answer, not that of the page.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'; style-src 'self'; \
     img-src 'self' blob: data:; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Answers requests as long as the program runs. Further connections wait until a thread is free.
pub(super) fn serve(listener: &TcpListener, page: &Path, port: u16) {
    let serve = || {
        for stream in listener.incoming().flatten() {
            // A connection that breaks off concerns nobody else.
            let _ = answer(Connection { stream, end: Instant::now() + PATIENCE }, page, port);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..THREADS {
            // This thread serves in any case.
            let _ = std::thread::Builder::new().spawn_scoped(scope, serve);
        }
        serve();
    });
}

/// A connection that is given up at a moment, however it goes on until then.
struct Connection {
    stream: TcpStream,
    end: Instant,
}

impl Connection {
    /// Time that is left.
    fn left(&self) -> std::io::Result<Duration> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() { Err(ErrorKind::TimedOut.into()) } else { Ok(left) }
    }
}

impl Read for Connection {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        self.stream.set_read_timeout(Some(self.left()?))?;
        self.stream.read(into)
    }
}

impl Write for Connection {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.stream.set_write_timeout(Some(self.left()?))?;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.stream.flush()
    }
}

/// Answers one request.
fn answer(mut connection: Connection, page: &Path, port: u16) -> std::io::Result<()> {
    let head = head(&mut connection)?;
    let (status, kind, body) = match file(&head, page, port) {
        Ok(path) => match std::fs::read(&path) {
            Ok(bytes) => ("200 OK", kind(&path), bytes),
            Err(_) => ("404 Not Found", "text/plain", b"not found\n".to_vec()),
        },
        Err(status) => (status, "text/plain", format!("{status}\n").into_bytes()),
    };
    let length = body.len();
    // One text, not one write for each of its pieces.
    let answer = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nX-Content-Type-Options: nosniff\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nContent-Security-Policy: {POLICY}\r\nCache-Control: no-cache\r\n\
         Connection: close\r\n\r\n"
    );
    connection.write_all(answer.as_bytes())?;
    if !head.first().is_some_and(|line| line.starts_with("HEAD ")) {
        connection.write_all(&body)?;
    }
    connection.flush()
}

/// The lines of a request up to the empty one.
fn head(connection: &mut Connection) -> std::io::Result<Vec<String>> {
    let mut lines = vec![];
    for line in BufReader::new(connection).take(MOST_HEAD).lines() {
        let line = line?;
        if line.is_empty() {
            break;
        }
        lines.push(line);
    }
    Ok(lines)
}

/// The file that a request asks for, or why there is none.
fn file(head: &[String], page: &Path, port: u16) -> Result<PathBuf, &'static str> {
    let mut words = head.first().map_or("", String::as_str).split(' ');
    let (Some(method), Some(target)) = (words.next(), words.next()) else { return Err("400 Bad Request") };
    if !["GET", "HEAD"].contains(&method) {
        return Err("405 Method Not Allowed");
    }
    let host = head.iter().filter_map(|line| line.split_once(':')).find(|(name, _)| name.eq_ignore_ascii_case("host"));
    if !host.is_some_and(|(_, host)| is_here(host.trim(), port)) {
        return Err("403 Forbidden");
    }
    let path = target.split(['?', '#']).next().unwrap_or_default();
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    if !path.starts_with('/') || !path.chars().all(plain) {
        return Err("404 Not Found");
    }
    let path = page.join(if path == "/" { "index.html" } else { &path[1..] });
    // Links and dots lead nowhere else.
    let real = path.canonicalize().map_err(|_| "404 Not Found")?;
    if real.starts_with(page) && real.is_file() { Ok(real) } else { Err("404 Not Found") }
}

/// Whether a `Host` is this server: another name for this machine is a page of somebody else that has found a way here. Browsers leave out port 80.
fn is_here(host: &str, port: u16) -> bool {
    let (name, given) = host.rsplit_once(':').unwrap_or((host, "80"));
    ["127.0.0.1", "localhost"].contains(&name) && given == port.to_string()
}

/// The type of a file, by its ending.
fn kind(path: &Path) -> &'static str {
    match path.extension().and_then(|ending| ending.to_str()).unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "wasm" => "application/wasm",
        "svg" => "image/svg+xml",
        "json" | "webmanifest" => "application/json",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_host_is_this_machine_with_the_port_that_a_browser_sends() {
        for (host, port, here) in [
            ("127.0.0.1:8000", 8000, true),
            ("localhost:8000", 8000, true),
            ("127.0.0.1:8001", 8000, false),
            ("127.0.0.1", 8000, false),
            ("127.0.0.1", 80, true),
            ("localhost", 80, true),
            ("localhost:80", 80, true),
            ("example.org", 80, false),
            ("localhost.example.org", 80, false),
            ("", 80, false),
        ] {
            assert_eq!(is_here(host, port), here, "{host} at port {port}");
        }
    }
}
