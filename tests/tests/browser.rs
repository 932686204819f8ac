//! Every shader module through the compiler of a browser, a second one beside naga and a stricter one: what
//! Chromium refuses, users of WebGPU cannot run.
#![cfg(unix)]

use isophote::kernels::KERNELS;
use isophote_engine::Rect;
use isophote_engine::program::{Precision, Program, Shader};
use isophote_tests::sweep;
use std::collections::BTreeMap;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Programs that are Chromium without a window.
const BROWSERS: [&str; 4] = ["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"];

/// When a browser that has not answered is taken for one that hangs.
const PATIENCE: Duration = Duration::from_secs(120);

/// Compiles `modules`, [name, source], and sends what is wrong with each, a line by module, to where it came from.
const SCRIPT: &str = "
const answer = async () => {
    const adapter = await navigator.gpu?.requestAdapter();
    if (!adapter) return 'no adapter';
    const device = await adapter.requestDevice();
    const wrong = [];
    for (const [name, code] of modules) {
        device.pushErrorScope('validation');
        const info = await device.createShaderModule({ code }).getCompilationInfo();
        const error = await device.popErrorScope();
        for (const m of info.messages) wrong.push(`${name}:${m.lineNum}:${m.linePos}: ${m.type}: ${m.message}`);
        if (error && !info.messages.length) wrong.push(`${name}: ${error.message}`);
    }
    return [`compiled ${modules.length}`, ...wrong].join('\\n');
};
answer().catch(String).then(body => fetch('/answer', { method: 'POST', body }));
";

#[test]
fn a_browser_compiles_every_shader() {
    let mut sources: BTreeMap<String, String> =
        KERNELS.iter().map(|kernel| (kernel.name.to_owned(), kernel.shader.to_owned())).collect();
    // Those of several kernels, in half precision, and with a sampler.
    for case in sweep::cases() {
        let [width, height] = case.plan.size();
        for precision in [Precision::Exact, Precision::Half, Precision::Fast] {
            let program = Program::lower_as(&case.plan, Rect::of_size(width, height), precision).unwrap();
            for dispatch in &program.dispatches {
                let Shader { name, source, .. } = &*dispatch.shader;
                let known = sources.entry(name.to_string()).or_insert_with(|| source.to_string());
                assert_eq!(known, source, "two shaders are named {name}");
            }
        }
    }
    println!("{} shaders, {} of them of one kernel as it is", sources.len(), KERNELS.len());
    let modules: Vec<[&str; 2]> = sources.iter().map(|(name, source)| [name.as_str(), source]).collect();
    let Some(answer) = compiled_by_a_browser(&modules) else { return };
    assert_eq!(answer, format!("compiled {}", modules.len()), "what the browser says of the shaders");
}

#[test]
fn a_number_beyond_the_greatest_float_is_refused() {
    // naga takes it for the greatest float, which it is when rounded.
    let source = "const LARGEST: f32 = 3.4028235e38;";
    let Some(answer) = compiled_by_a_browser(&[["rounded", source]]) else { return };
    assert!(answer.contains("rounded:1:") && answer.contains("cannot be represented"), "{answer}");
}

/// Messages of a browser about the modules; `None` where there is no browser and need not be one.
fn compiled_by_a_browser(modules: &[[&str; 2]]) -> Option<String> {
    let Some(program) = browser() else {
        assert!(std::env::var_os("ISOPHOTE_REQUIRE_GPU").is_none(), "none of {BROWSERS:?} is installed");
        println!("skipped: none of {BROWSERS:?} is installed");
        return None;
    };
    let modules = serde_json::to_string(modules).unwrap().replace("</", "<\\/");
    let page = format!("<!doctype html><script>const modules = {modules};{SCRIPT}</script>");
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let profile = tempfile::tempdir().unwrap();
    let mut running = Running(start(&program, profile.path(), listener.local_addr().unwrap().port()));
    let answer = serve(&listener, &page, &mut running.0);
    drop(running);
    Some(answer.unwrap())
}

fn browser() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    BROWSERS
        .iter()
        .find_map(|name| std::env::split_paths(&path).map(|dir| dir.join(name)).find(|p| p.is_file()))
}

fn start(program: &Path, profile: &Path, port: u16) -> Child {
    Command::new(program)
        // Containers give neither a sandbox nor a graphics card.
        .args(["--headless", "--no-sandbox", "--disable-dev-shm-usage", "--remote-debugging-port=0"])
        .args(["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("http://127.0.0.1:{port}/"))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .process_group(0)
        .spawn()
        .unwrap()
}

/// A browser with all of its processes, which are a group.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let group = format!("-{}", self.0.id());
        let _ = Command::new("kill").args(["-KILL", "--", &group]).status();
        let _ = self.0.wait();
    }
}

/// Hands out the page until its answer comes.
fn serve(listener: &TcpListener, page: &str, browser: &mut Child) -> io::Result<String> {
    listener.set_nonblocking(true)?;
    let started = Instant::now();
    while started.elapsed() < PATIENCE {
        match listener.accept() {
            Ok((stream, _)) => {
                if let Some(answer) = respond(stream, page)? {
                    return Ok(answer);
                }
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                if let Some(status) = browser.try_wait()? {
                    return Err(io::Error::other(format!("the browser ended with {status}")));
                }
                std::thread::sleep(Duration::from_millis(20));
            }
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::other("the browser does not answer"))
}

/// The page for a GET, the body of a POST.
fn respond(stream: TcpStream, page: &str) -> io::Result<Option<String>> {
    stream.set_nonblocking(false)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    let mut reader = BufReader::new(&stream);
    let (mut request, mut length) = (String::new(), 0);
    // Browsers open connections in advance and may close them unused.
    if reader.read_line(&mut request)? == 0 {
        return Ok(None);
    }
    loop {
        let mut line = String::new();
        if reader.read_line(&mut line)? == 0 || line.trim_end().is_empty() {
            break;
        }
        if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
            length = value.trim().parse().map_err(io::Error::other)?;
        }
    }
    let is_answer = request.starts_with("POST ");
    let mut body = vec![0; length];
    reader.read_exact(&mut body)?;
    let content = if is_answer { "" } else { page };
    write!(
        &stream,
        "HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{content}",
        content.len()
    )?;
    Ok(is_answer.then(|| String::from_utf8_lossy(&body).into_owned()))
}
