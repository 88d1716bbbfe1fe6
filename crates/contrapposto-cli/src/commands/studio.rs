//! `contrapposto studio`: serves the built page of the studio on this machine alone, and opens it in the browser.
//!
//! The server knows GET and HEAD of files below the page's folder, answers requests whose `Host` is this machine, and nothing else.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use contrapposto_formats::MOST_BYTES;

use crate::args::StudioArgs;
use crate::fail::Fail;
use crate::input::read;
use crate::output::{print, print_note};

/// Longest head of a request, bytes.
const MOST_HEAD: u64 = 16 << 10;
/// Longest wait for a request, s.
const PATIENCE: Duration = Duration::from_secs(10);
/// Longest scenario that an address can hold in every browser, and an argument on Linux, bytes.
const MOST_IN_ADDRESS: usize = 64 << 10;
/// Content policy: lists all that the page and its workers may load. A worker takes the policy of its own answer, not that of the page.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'; style-src 'self'; \
     img-src 'self' blob: data:; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

pub(crate) fn studio(args: &StudioArgs) -> Result<(), Fail> {
    let page = page(args.page.as_deref())?;
    let fragment = args.scenario.as_deref().map(fragment).transpose()?.unwrap_or_default();
    let refused = |error: std::io::Error| Fail::Job(format!("port {} of this machine: {error}", args.port));
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, args.port)).map_err(refused)?;
    let port = listener.local_addr().map_err(refused)?.port();
    let address = format!("http://127.0.0.1:{port}/");
    print(&format!("{address}{fragment}\n"))?;
    print_note("studio", &format!("the page is served from {}; Ctrl-C ends it", page.display()));
    if !args.no_browser {
        open(&format!("{address}{fragment}"));
    }
    for stream in listener.incoming().flatten() {
        let page = page.clone();
        // A connection that breaks off concerns nobody else; one for which there is no thread is closed.
        let _ = std::thread::Builder::new().spawn(move || drop(answer(&stream, &page, port)));
    }
    Ok(())
}

/// The folder of the built page.
fn page(given: Option<&Path>) -> Result<PathBuf, Fail> {
    let is_page = |folder: &Path| folder.join("index.html").is_file() && folder.join("assets").is_dir();
    let how = "build it in the repository with `cd web && npm ci && npm run build`, then name it: --page web/dist";
    if let Some(folder) = given {
        let real = folder.canonicalize().ok().filter(|real| is_page(real));
        return real.ok_or_else(|| {
            Fail::Refused(format!("--page {}: is not the built page of the studio; {how}", folder.display()))
        });
    }
    let beside = std::env::current_exe().ok().and_then(|program| Some(program.parent()?.to_owned()));
    let known = beside.iter().map(|folder| folder.join("web/dist")).chain([PathBuf::from("web/dist")]);
    let found = known.filter_map(|folder| folder.canonicalize().ok()).find(|folder| is_page(folder));
    found.ok_or_else(|| Fail::Refused(format!("the page of the studio is not here; {how}")))
}

/// The part of the address that holds a scenario.
fn fragment(path: &Path) -> Result<String, Fail> {
    let bytes = read(path, MOST_BYTES)?;
    if bytes.len() > MOST_IN_ADDRESS {
        let (name, size) = (path.display(), bytes.len());
        return Err(Fail::Refused(format!(
            "{name}: is {size} bytes long; an address holds {MOST_IN_ADDRESS}. Drop the file on the page instead"
        )));
    }
    Ok(format!("#scenario={}", URL_SAFE_NO_PAD.encode(bytes)))
}

/// Opens an address in the user's browser; where that fails, the address was printed.
fn open(address: &str) {
    let (program, words): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("rundll32", &["url.dll,FileProtocolHandler"])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    command.args(words).arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    if command.spawn().is_err() {
        print_note("studio", "no browser could be opened; open the address above in one");
    }
}

/// Answers one request.
fn answer(stream: &TcpStream, page: &Path, port: u16) -> std::io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let head = head(stream)?;
    let (status, kind, body) = match file(&head, page, port) {
        Ok(path) => match std::fs::read(&path) {
            Ok(bytes) => ("200 OK", kind(&path), bytes),
            Err(_) => ("404 Not Found", "text/plain", b"not found\n".to_vec()),
        },
        Err(status) => (status, "text/plain", format!("{status}\n").into_bytes()),
    };
    let length = body.len();
    let mut out = stream;
    write!(
        out,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nX-Content-Type-Options: nosniff\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nContent-Security-Policy: {POLICY}\r\nCache-Control: no-cache\r\n\
         Connection: close\r\n\r\n"
    )?;
    if !head.first().is_some_and(|line| line.starts_with("HEAD ")) {
        out.write_all(&body)?;
    }
    out.flush()
}

/// The lines of a request up to the empty one.
fn head(stream: &TcpStream) -> std::io::Result<Vec<String>> {
    let mut lines = vec![];
    for line in BufReader::new(stream).take(MOST_HEAD).lines() {
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
    // Another name for this machine is a page of somebody else that has found a way here.
    let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let host = head.iter().filter_map(|line| line.split_once(':')).find(|(name, _)| name.eq_ignore_ascii_case("host"));
    if !host.is_some_and(|(_, host)| hosts.iter().any(|own| own == host.trim())) {
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
