//! How much memory a page takes, by the browser's own counts and by the system's.

use std::collections::BTreeMap;
use std::fs;
use std::net::TcpStream;

use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use super::adapter::Adapter;
use super::browser::Browser;

/// What the page and its workers hold, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Held {
    /// Objects of JavaScript, after the garbage has been collected.
    pub heaps: f64,
    /// Memories of WebAssembly. They never shrink.
    pub wasm: f64,
}

impl Browser {
    /// What the page that is open and its workers hold.
    pub fn held_bytes(&self) -> Held {
        let mut tools = DeveloperTools::connect(self);
        let targets = tools.call(None, "Target.getTargets", &json!({}));
        let targets = targets["targetInfos"].as_array().cloned().unwrap_or_default();
        let ours = targets.iter().filter(|target| {
            let address = target["url"].as_str().unwrap_or_default();
            matches!(target["type"].as_str(), Some("page" | "worker")) && address.starts_with("http")
        });
        let mut held = Held::default();
        for target in ours {
            let attached = json!({ "targetId": target["targetId"], "flatten": true });
            let attached = tools.call(None, "Target.attachToTarget", &attached);
            let session = attached["sessionId"].as_str().expect("a target takes a session").to_owned();
            let session = Some(session.as_str());
            tools.call(session, "HeapProfiler.collectGarbage", &json!({}));
            held.heaps += tools.call(session, "Runtime.getHeapUsage", &json!({}))["usedSize"].as_f64().unwrap_or(0.0);
            let kind =
                tools.call(session, "Runtime.evaluate", &json!({ "expression": "WebAssembly.Memory.prototype" }));
            let all = json!({ "prototypeObjectId": kind["result"]["objectId"] });
            let all = tools.call(session, "Runtime.queryObjects", &all);
            let sum = json!({
                "objectId": all["objects"]["objectId"],
                "functionDeclaration": "function() { return this.reduce((sum, { buffer }) => sum + buffer.byteLength, 0); }",
                "returnByValue": true,
            });
            held.wasm += tools.call(session, "Runtime.callFunctionOn", &sum)["result"]["value"].as_f64().unwrap_or(0.0);
        }
        held
    }
}

/// A connection to the browser beside the driver's, for what the driver does not hand through.
struct DeveloperTools {
    socket: WebSocket<TcpStream>,
    last: u64,
}

impl DeveloperTools {
    fn connect(browser: &Browser) -> Self {
        let place =
            fs::read_to_string(browser.profile().join("DevToolsActivePort")).expect("the browser tells its port");
        let (port, path) = place.split_once('\n').expect("a port and a path");
        let stream = TcpStream::connect(format!("127.0.0.1:{port}")).expect("the browser listens");
        let address = format!("ws://127.0.0.1:{port}{}", path.trim());
        let (socket, _) = tungstenite::client(address, stream).expect("the browser speaks of itself");
        Self { socket, last: 0 }
    }

    fn call(&mut self, session: Option<&str>, method: &str, params: &Value) -> Value {
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

impl Adapter {
    /// Bytes that the browser's processes which draw pages have in memory, all together.
    pub fn resident_bytes(&self) -> f64 {
        let mut processes = BTreeMap::new();
        for entry in fs::read_dir("/proc").expect("a system with /proc").flatten() {
            if let Ok(id) = entry.file_name().to_string_lossy().parse::<u32>() {
                // A process may have ended meanwhile.
                let Ok(status) = fs::read_to_string(entry.path().join("status")) else { continue };
                let command = fs::read(entry.path().join("cmdline")).unwrap_or_default();
                let draws = command.windows(15).any(|part| part == b"--type=renderer");
                let field = |name: &str| {
                    let line = status.lines().find_map(|line| line.strip_prefix(name));
                    line.and_then(|line| line.split_whitespace().next()?.parse::<u32>().ok()).unwrap_or_default()
                };
                processes.insert(id, (field("PPid:"), draws, field("VmRSS:")));
            }
        }
        let is_ours = |id: u32| {
            let parents = std::iter::successors(Some(id), |id| processes.get(id).map(|(parent, ..)| *parent));
            parents.take(64).any(|id| id == self.process_id())
        };
        let kilobytes = processes.iter().filter(|(id, (_, draws, _))| *draws && is_ours(**id));
        kilobytes.map(|(_, (.., resident))| f64::from(*resident) * 1024.0).sum()
    }
}
