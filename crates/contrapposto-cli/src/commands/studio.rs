//! `contrapposto studio`: serves the built page of the studio on this machine alone, and opens it in the browser.

mod server;

use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use contrapposto_formats::MOST_BYTES;

use crate::args::StudioArgs;
use crate::fail::Fail;
use crate::input::read;
use crate::output::{print, print_note};

/// Longest scenario that an address can hold in every browser, and an argument on Linux, bytes.
const MOST_IN_ADDRESS: usize = 64 << 10;

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
    server::serve(&listener, &page, port);
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
