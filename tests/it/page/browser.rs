//! Chromium without a window.

use std::fs;
use std::process::Command;

use serde_json::Value;

/// A browser that is installed.
pub struct Browser {
    program: &'static str,
}

impl Browser {
    /// The first one that is on PATH.
    pub fn find() -> Option<Self> {
        let names = ["chromium", "chromium-browser", "google-chrome"];
        let program = names
            .into_iter()
            .find(|name| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success()))?;
        Some(Self { program })
    }

    /// Opens a page, runs `questions` at its end, and gives what they leave as `answers`. Errors of scripts are
    /// under `errors`.
    pub fn ask(&self, page: &str, questions: &str) -> Value {
        let folder = tempfile::tempdir().unwrap();
        let early = "<head><script>window.answers = { errors: [] };\
                     addEventListener('error', e => answers.errors.push(e.message));\
                     addEventListener('unhandledrejection', e => answers.errors.push(String(e.reason)));\
                     addEventListener('securitypolicyviolation', e => answers.errors.push(e.violatedDirective));</script>";
        let late = format!("<script>{questions}</script></body>");
        let (before, after) = page.rsplit_once("</body>").unwrap();
        let page = format!("{}{late}{after}", before.replacen("<head>", early, 1));
        let file = folder.path().join("page.html");
        fs::write(&file, page).unwrap();
        let output = Command::new(self.program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--window-size=1280,1000",
                "--virtual-time-budget=20000",
            ])
            .args(["--no-first-run", "--disable-extensions", "--disable-background-networking"])
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .arg("--dump-dom")
            .arg(format!("file://{}", file.display()))
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        let answers = text.split("<pre id=\"answers\">").nth(1).and_then(|rest| rest.split("</pre>").next());
        let answers = answers.unwrap_or_else(|| panic!("{}\n{text}", String::from_utf8_lossy(&output.stderr)));
        let answers = answers.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
        serde_json::from_str(&answers).unwrap_or_else(|e| panic!("{e}: {answers}"))
    }
}
