//! The headers of every answer: one table for `serve` and for the file that static hosts read.

use std::fmt::Write;

use Scope::{Everything, Named, Shell};

/// Which paths a rule applies to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scope {
    /// Every path.
    Everything,
    /// Files whose name tells their content.
    Named,
    /// The page itself.
    Shell,
}

/// The page and its worker run what comes from here and nothing else; the page can be in no frame.
/// `require-trusted-types-for` is missing because the workers are started by their addresses.
const CONTENT_SECURITY_POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
     img-src 'self' data:; connect-src 'self'; worker-src 'self'; font-src 'self'; manifest-src 'self'; \
     base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const PERMISSIONS_POLICY: &str = "serial=(self), accelerometer=(), autoplay=(), browsing-topics=(), \
     camera=(), display-capture=(), encrypted-media=(), geolocation=(), gyroscope=(), hid=(), \
     identity-credentials-get=(), idle-detection=(), local-fonts=(), magnetometer=(), microphone=(), midi=(), \
     payment=(), publickey-credentials-get=(), usb=(), xr-spatial-tracking=()";

const RULES: &[(Scope, &str, &str)] = &[
    (Everything, "Content-Security-Policy", CONTENT_SECURITY_POLICY),
    (Everything, "Permissions-Policy", PERMISSIONS_POLICY),
    (Everything, "Referrer-Policy", "no-referrer"),
    (Everything, "X-Content-Type-Options", "nosniff"),
    (Everything, "Cross-Origin-Opener-Policy", "same-origin"),
    (Everything, "Cross-Origin-Embedder-Policy", "require-corp"),
    (Everything, "Cross-Origin-Resource-Policy", "same-origin"),
    (Named, "Cache-Control", "public, max-age=31536000, immutable"),
    (Shell, "Cache-Control", "no-cache"),
];

/// Names and values for an answer to `path`, which begins with a slash.
pub(crate) fn of(path: &str) -> impl Iterator<Item = (&'static str, &'static str)> {
    RULES.iter().filter(move |(scope, ..)| scope.covers(path)).map(|&(_, name, value)| (name, value))
}

/// The text of `_headers`. `files` are the paths of the site's files, each beginning with a slash.
pub(crate) fn file<'a>(files: impl Iterator<Item = &'a str>) -> String {
    let mut text = String::new();
    let mut block = |pattern: &str, scope: Scope| {
        text += pattern;
        text.push('\n');
        for (_, name, value) in RULES.iter().filter(|rule| rule.0 == scope) {
            let _ = writeln!(text, "  {name}: {value}");
        }
    };
    block("/*", Everything);
    block("/", Shell);
    for path in files {
        block(path, if Named.covers(path) { Named } else { Shell });
    }
    text
}

impl Scope {
    fn covers(self, path: &str) -> bool {
        // The build gives every file but the page a name of this form.
        let named = path.starts_with("/buslens-");
        match self {
            Everything => true,
            Named => named,
            Shell => !named,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn page_is_asked_for_again_and_named_files_are_kept() {
        let cache = |path| of(path).find(|header| header.0 == "Cache-Control").map(|header| header.1);
        assert_eq!(cache("/"), Some("no-cache"));
        assert_eq!(cache("/index.html"), Some("no-cache"));
        assert_eq!(cache("/buslens-0123456789.js"), Some("public, max-age=31536000, immutable"));
    }

    #[test]
    fn every_answer_has_the_policies_once() {
        for path in ["/", "/buslens-0123456789.wasm", "/nothing-here"] {
            let names: Vec<_> = of(path).map(|header| header.0).collect();
            let mut once = names.clone();
            once.sort_unstable();
            once.dedup();
            assert_eq!(once.len(), names.len(), "{path}");
            assert!(names.contains(&"Content-Security-Policy"), "{path}");
        }
    }

    #[test]
    fn script_comes_only_from_here() {
        let script = CONTENT_SECURITY_POLICY.split("; ").find(|part| part.starts_with("script-src"));
        assert_eq!(script, Some("script-src 'self' 'wasm-unsafe-eval'"));
    }

    #[test]
    fn file_for_hosts_says_what_serve_says() {
        let paths = ["/index.html", "/buslens-0123456789.css"];
        let text = file(paths.into_iter());
        for path in paths {
            // A host joins the block for all paths and the block for this one.
            let block = |pattern: &str| {
                let lines = text.lines().skip_while(move |line| *line != pattern).skip(1);
                lines.take_while(|line| line.starts_with("  ")).map(str::trim).map(str::to_owned).collect::<Vec<_>>()
            };
            let joined = [block("/*"), block(path)].concat();
            let served: Vec<_> = of(path).map(|(name, value)| format!("{name}: {value}")).collect();
            assert_eq!(joined, served, "{path}");
        }
    }
}
