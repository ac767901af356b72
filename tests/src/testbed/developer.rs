//! The browser's developer tools, beside its driver.

use std::fs;
use std::net::TcpStream;

use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use super::browser::Browser;

/// A connection to the browser beside the driver's, for what the driver does not hand through.
pub(super) struct DeveloperTools {
    socket: WebSocket<TcpStream>,
    last: u64,
}

impl DeveloperTools {
    pub(super) fn connect(browser: &Browser) -> Self {
        let place =
            fs::read_to_string(browser.profile().join("DevToolsActivePort")).expect("the browser tells its port");
        let (port, path) = place.split_once('\n').expect("a port and a path");
        let stream = TcpStream::connect(format!("127.0.0.1:{port}")).expect("the browser listens");
        let address = format!("ws://127.0.0.1:{port}{}", path.trim());
        let (socket, _) = tungstenite::client(address, stream).expect("the browser speaks of itself");
        Self { socket, last: 0 }
    }

    /// Sessions with the page that is open and with its workers.
    pub(super) fn attach(&mut self) -> Vec<String> {
        let targets = self.call(None, "Target.getTargets", &json!({}));
        let targets = targets["targetInfos"].as_array().cloned().unwrap_or_default();
        let ours = targets.iter().filter(|target| {
            let address = target["url"].as_str().unwrap_or_default();
            matches!(target["type"].as_str(), Some("page" | "worker")) && address.starts_with("http")
        });
        let session = |target: &Value| {
            let attached = json!({ "targetId": target["targetId"], "flatten": true });
            let attached = self.call(None, "Target.attachToTarget", &attached);
            attached["sessionId"].as_str().expect("a target takes a session").to_owned()
        };
        ours.map(session).collect()
    }

    /// Sends a command and returns its result.
    pub(super) fn call(&mut self, session: Option<&str>, method: &str, params: &Value) -> Value {
        self.last += 1;
        let mut call = json!({ "id": self.last, "method": method, "params": params });
        if let Some(session) = session {
            call["sessionId"] = session.into();
        }
        self.socket.send(Message::text(call.to_string())).expect("the browser listens");
        loop {
            let answer = self.socket.read().expect("the browser answers");
            let answer: Value = serde_json::from_str(answer.to_text().unwrap_or_default()).unwrap_or_default();
            if answer["id"] == self.last {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
        }
    }
}

impl Browser {
    /// From now on the page and the workers that it has get no file whose address contains `part`.
    pub fn withhold(&self, part: &str) -> Withheld {
        let mut tools = DeveloperTools::connect(self);
        let sessions = tools.attach();
        let mut withheld = Withheld { tools, sessions };
        for session in &withheld.sessions {
            withheld.tools.call(Some(session), "Network.enable", &json!({}));
        }
        withheld.block(&[format!("*{part}*")]);
        withheld
    }
}

/// Files that do not come.
pub struct Withheld {
    tools: DeveloperTools,
    sessions: Vec<String>,
}

impl Withheld {
    /// Other files do not come instead.
    pub fn instead(&mut self, part: &str) {
        self.block(&[format!("*{part}*")]);
    }

    /// Everything comes again.
    pub fn end(mut self) {
        self.block(&[]);
    }

    fn block(&mut self, patterns: &[String]) {
        for session in &self.sessions {
            self.tools.call(Some(session), "Network.setBlockedURLs", &json!({ "urls": patterns }));
        }
    }
}
