//! An X server of the test's own, with a touchscreen, a mouse, a keyboard and a window manager.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::At;
use super::picture::Picture;

/// The software Vulkan driver. The dummy display has no card; a real one could not show its pictures there.
const LAVAPIPE: &str = "/usr/share/vulkan/icd.d/lvp_icd.x86_64.json";

/// The X server's driver for injected input.
const INPUTTEST: &str = "/usr/lib/xorg/modules/input/inputtest_drv.so";

/// What of the equipment is not on this machine.
pub(super) fn missing() -> Vec<String> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let tools = [
        "Xorg", "openbox", "xinput", "xwininfo", "xprop", "import", "python3",
    ];
    let absent = |tool: &&str| !std::env::split_paths(&path).any(|dir| dir.join(tool).is_file());
    let tools = tools.into_iter().filter(absent);
    let files = [LAVAPIPE, INPUTTEST]
        .into_iter()
        .filter(|file| !Path::new(file).is_file());
    tools.chain(files).map(str::to_owned).collect()
}

/// A running X server and its window manager.
pub(super) struct Display {
    /// What programs on it need to find it, and injectors to find its devices.
    environment: BTreeMap<String, String>,
    window_manager: Child,
    server: Child,
}

impl Display {
    pub(super) fn start(folder: &Path, (width, height): (u32, u32)) -> Self {
        let errors = File::create(folder.join("server.err")).unwrap();
        // The server lives as long as `cat`, and `cat` as long as this process holds its input: nothing is left over
        // even where the test is killed.
        let mut server = Command::new(touch_x("with-touch-x.sh"))
            .args([
                "-s",
                &format!("{width}x{height}"),
                "sh",
                "-c",
                "env; echo; exec cat",
            ])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(errors)
            .spawn()
            .unwrap();
        let environment = environment(server.stdout.take().unwrap());
        let display = environment.get("DISPLAY").cloned().unwrap_or_default();
        assert!(
            !display.is_empty(),
            "no X server; see {}",
            folder.join("server.err").display()
        );
        let mut display = Self {
            window_manager: Command::new("true").spawn().unwrap(),
            environment,
            server,
        };
        display.window_manager = display
            .command("openbox")
            .args(["--config-file", "/etc/xdg/openbox/rc.xml"])
            .stdout(Stdio::null())
            .stderr(File::create(folder.join("openbox.err")).unwrap())
            .spawn()
            .unwrap();
        display.await_window_manager();
        display
    }

    /// A command on this display.
    pub(super) fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new(program);
        command
            .envs(&self.environment)
            .env("VK_DRIVER_FILES", LAVAPIPE)
            .env("VK_ICD_FILENAMES", LAVAPIPE)
            .env_remove("WGPU_BACKEND")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET");
        command
    }

    /// What a tool prints.
    fn output(&self, program: &str, arguments: &[&str]) -> String {
        let output = self.command(program).args(arguments).output().unwrap();
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// A window that opens before the window manager runs would get no focus, and so no keys.
    fn await_window_manager(&self) {
        let until = Instant::now() + Duration::from_secs(20);
        while !self
            .output("xprop", &["-root", "_NET_SUPPORTING_WM_CHECK"])
            .contains("window id")
        {
            assert!(Instant::now() < until, "openbox did not start");
            thread::sleep(Duration::from_millis(50));
        }
    }

    /// Switches the touchscreen on (`enable`) or off (`disable`).
    pub(super) fn xinput(&self, switch: &str) {
        let status = self.command("xinput").args([switch, "touch0"]).status().unwrap();
        assert!(status.success(), "xinput {switch}");
    }

    /// Where the inside of the program's window begins on the screen.
    pub(super) fn window_origin(&self) -> At {
        let active = self.output("xprop", &["-root", "-notype", "_NET_ACTIVE_WINDOW"]);
        let id = active.trim().rsplit(' ').next().unwrap_or_default().to_owned();
        let facts = self.output("xwininfo", &["-id", &id]);
        let number = |name: &str| {
            let line = facts.lines().find(|line| line.contains(name));
            line.and_then(|line| line.rsplit(' ').next()?.parse().ok())
                .unwrap_or_else(|| panic!("`{name}` of the active window {id}, got: {facts}"))
        };
        (number("Absolute upper-left X"), number("Absolute upper-left Y"))
    }

    /// Takes a picture of the whole screen.
    pub(super) fn screenshot(&self, file: &Path) -> Picture {
        let status = self
            .command("import")
            .args(["-window", "root"])
            .arg(file)
            .status()
            .unwrap();
        assert!(status.success(), "import");
        Picture::read(file)
    }

    /// Copies what would go with the server.
    pub(super) fn keep_evidence(&self, folder: &Path) {
        let _ = self
            .command("import")
            .args(["-window", "root"])
            .arg(folder.join("at-the-end.png"))
            .status();
        if let Some(private) = self
            .environment
            .get("TOUCH_SOCK")
            .and_then(|socket| Path::new(socket).parent())
        {
            let _ = fs::copy(private.join("Xorg.log"), folder.join("Xorg.log"));
        }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.window_manager.kill();
        let _ = self.window_manager.wait();
        drop(self.server.stdin.take());
        let _ = self.server.wait();
    }
}

/// A file of the touch equipment.
pub(super) fn touch_x(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/touch-x")
        .join(name)
}

/// The variables up to the empty line.
fn environment(printed: ChildStdout) -> BTreeMap<String, String> {
    let wanted = [
        "DISPLAY",
        "XDG_RUNTIME_DIR",
        "TOUCH_SOCK",
        "PTR_SOCK",
        "KBD_SOCK",
        "TOUCH_W",
        "TOUCH_H",
    ];
    let lines = BufReader::new(printed).lines().map_while(Result::ok);
    lines
        .take_while(|line| !line.is_empty())
        .filter_map(|line| {
            line.split_once('=')
                .map(|(name, value)| (name.to_owned(), value.to_owned()))
        })
        .filter(|(name, _)| wanted.contains(&name.as_str()))
        .collect()
}
