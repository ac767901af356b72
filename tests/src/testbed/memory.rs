//! How much memory a page takes, by the browser's own counts and by the system's.

use std::collections::BTreeMap;
use std::fs;

use serde_json::json;

use super::adapter::Adapter;
use super::browser::Browser;
use super::developer::DeveloperTools;

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
        let mut held = Held::default();
        for session in tools.attach() {
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
