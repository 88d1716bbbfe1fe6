//! `contrapposto studio`: the page is served on this machine, and nothing else is.

use crate::support;

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use support::run;

/// A server that ends with the test.
struct Server(Child);

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Serves a page of two files; gives the server, its port and the fragment of the printed address.
fn serve(folder: &Path, scenario: Option<&str>) -> (Server, u16, String) {
    let page = folder.join("page");
    std::fs::create_dir_all(page.join("assets")).unwrap();
    std::fs::write(page.join("index.html"), "<p>studio</p>").unwrap();
    std::fs::write(page.join("assets/a.wasm"), "module").unwrap();
    std::fs::write(folder.join("secret.txt"), "secret").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_contrapposto"));
    command.args(["studio", "--no-browser", "--page"]).arg(&page).stdout(Stdio::piped()).stderr(Stdio::null());
    command.args(scenario);
    let mut server = Server(command.spawn().unwrap());
    let mut line = String::new();
    BufReader::new(server.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let (port, fragment) = line.trim().strip_prefix("http://127.0.0.1:").unwrap().split_once('/').unwrap();
    (server, port.parse().unwrap(), fragment.to_owned())
}

/// The answer to a request for `target` in the name of `host`.
fn ask(port: u16, method: &str, target: &str, host: &str) -> String {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    write!(stream, "{method} {target} HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

#[test]
fn the_files_of_the_page_are_served_with_their_types() {
    let folder = tempfile::tempdir().unwrap();
    let (_server, port, fragment) = serve(folder.path(), None);
    let host = format!("127.0.0.1:{port}");
    let index = ask(port, "GET", "/", &host);
    assert!(index.starts_with("HTTP/1.1 200 OK") && index.ends_with("<p>studio</p>"), "{index}");
    let module = ask(port, "GET", "/assets/a.wasm?x", &format!("localhost:{port}"));
    assert!(module.contains("application/wasm") && module.ends_with("module"), "{module}");
    let head = ask(port, "HEAD", "/index.html", &host);
    assert!(head.contains("Content-Length: 13") && head.ends_with("\r\n\r\n"), "{head}");
    assert_eq!(fragment, "");
}

#[test]
fn other_files_methods_and_hosts_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (_server, port, _) = serve(folder.path(), None);
    let host = format!("127.0.0.1:{port}");
    for (method, target, host, status) in [
        ("GET", "/../secret.txt", host.as_str(), "404"),
        ("GET", "/%2e%2e/secret.txt", &host, "404"),
        ("GET", "//etc/passwd", &host, "404"),
        ("GET", "/assets", &host, "404"),
        ("POST", "/", &host, "405"),
        ("GET", "/", "example.org", "403"),
        ("GET", "", &host, "404"),
    ] {
        let answer = ask(port, method, target, host);
        assert!(answer.starts_with(&format!("HTTP/1.1 {status}")), "{method} {target} {host}: {answer}");
        assert!(!answer.contains("secret"), "{answer}");
    }
}

#[test]
fn slow_connections_take_no_more_than_some_threads_and_some_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let (server, port, _) = serve(folder.path(), None);
    let mut slow: Vec<TcpStream> = (0..40).map(|_| TcpStream::connect(("127.0.0.1", port)).unwrap()).collect();
    let begin = Instant::now();
    let mut open = true;
    // A byte a second is faster than the wait for one read.
    while open && begin.elapsed() < Duration::from_secs(30) {
        for stream in &mut slow {
            let _ = stream.write_all(b"G");
        }
        std::thread::sleep(Duration::from_secs(1));
        if cfg!(target_os = "linux") {
            let status = std::fs::read_to_string(format!("/proc/{}/status", server.0.id())).unwrap();
            let threads = status.lines().find_map(|line| line.strip_prefix("Threads:")).unwrap();
            assert!(threads.trim().parse::<usize>().unwrap() <= 16, "{threads} threads");
        }
        slow[0].set_read_timeout(Some(Duration::from_millis(1))).unwrap();
        let read = slow[0].read(&mut [0]);
        open = read.is_err_and(|error| [ErrorKind::WouldBlock, ErrorKind::TimedOut].contains(&error.kind()));
    }
    assert!(!open, "a slow connection is open after {} s", begin.elapsed().as_secs());
    drop(slow);
    assert!(ask(port, "GET", "/", &format!("127.0.0.1:{port}")).starts_with("HTTP/1.1 200 OK"));
}

#[test]
fn the_address_holds_the_scenario() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("job.toml");
    std::fs::write(&file, "format = 1\n").unwrap();
    let (_server, _, fragment) = serve(folder.path(), file.to_str());
    assert_eq!(fragment, "#scenario=Zm9ybWF0ID0gMQo");
}

#[test]
fn without_the_page_the_program_says_how_to_get_it() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(&["studio", "--no-browser", "--page", folder.path().to_str().unwrap()]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("npm ci && npm run build"), "{}", run.stderr);
}
