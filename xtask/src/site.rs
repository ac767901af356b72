//! Builds the deployable site: compiles, binds, names files by their content, compresses, weighs.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, process};

use anyhow::{Context, Result, ensure};
use brotli::enc::BrotliEncoderParams;
use flate2::Compression;
use flate2::write::GzEncoder;
use sha2::{Digest, Sha256};
use wasm_bindgen_cli_support::Bindgen;

use crate::toolchain::{TARGET, Wasm};
use crate::{headers, machine, minify};

/// The most that a first visit may transfer, in bytes.
const BUDGET: usize = 150_000;

/// How to build.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Options {
    /// Compile the standard library from Debian's packages even if the target is installed.
    pub(crate) debian_std: bool,
    /// Keep function names. Such a site is for debugging and has no budget.
    pub(crate) symbols: bool,
    /// Compile and compress quickly. Such a site is for trying things out and has no budget.
    pub(crate) quick: bool,
}

/// What the first visit to a built site transfers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FirstLoad {
    /// Bytes of all files, compressed with brotli.
    bytes: usize,
    /// The most that they may be.
    budget: usize,
}

impl FirstLoad {
    /// Fails if the site is heavier than its budget.
    pub(crate) fn check(self) -> Result<()> {
        let Self { bytes, budget } = self;
        ensure!(bytes <= budget, "the first load is {bytes} bytes, more than the {budget} that are allowed");
        Ok(())
    }
}

/// Builds the site into `folder`, which is replaced as a whole.
pub(crate) fn build(options: Options, folder: &Path) -> Result<FirstLoad> {
    let toolchain = Wasm::find(options.debian_std)?;
    let programs = [PAGE, WORKBENCH, SIMULATOR, ANALYST].map(|program| compile(toolchain, program, options));
    println!("site: binding and compressing");
    let [page, workbench, simulator, analyst] = programs.map(|compiled| bind(&compiled?, options.symbols));
    let site = assemble(&page?, &workbench?, &simulator?, &analyst?)?;
    let pack =
        |files: Vec<File>| files.into_iter().map(|file| Packed::new(file, options.quick)).collect::<Result<Vec<_>>>();
    let (first, later) = (pack(site.first)?, pack(site.later)?);
    write(first.iter().chain(&later), folder)?;
    print!("{}", table(&first, &later));
    let bytes = first.iter().map(|file| file.brotli.len()).sum();
    Ok(FirstLoad { bytes, budget: if options.symbols || options.quick { usize::MAX } else { BUDGET } })
}

/// A program of the site: its package, its binary, and the profile that it is compiled with.
#[derive(Clone, Copy)]
struct Program {
    package: &'static str,
    name: &'static str,
    profile: &'static str,
}

/// The page with its engine.
const PAGE: Program = Program { package: "buslens", name: "buslens", profile: "site" };
/// Explains and builds frames; loaded when there is one to explain.
const WORKBENCH: Program = Program { package: "buslens", name: "buslens-workbench", profile: "site" };
/// The line of a demonstration; loaded when somebody connects to it.
const SIMULATOR: Program = Program { package: "buslens", name: "buslens-simulator", profile: "site" };
/// Reads whole texts; loaded when there is one to read.
const ANALYST: Program = Program { package: "buslens-analyst", name: "buslens-analyst", profile: "analyst" };

fn compile(toolchain: Wasm, program: Program, options: Options) -> Result<PathBuf> {
    let Program { package, name, profile } = program;
    let profile = if options.quick { "quick" } else { profile };
    println!("site: compiling {name}");
    let mut cargo = toolchain.cargo("build");
    cargo.args(["--package", package, "--bin", name, "--profile", profile]);
    // Panic messages name source files. Without this they would name this machine's folders.
    cargo.env("CARGO_ENCODED_RUSTFLAGS", short_paths().join("\u{1f}"));
    machine::run(&mut cargo)?;
    Ok(machine::root().join("target/wasm").join(TARGET).join(profile).join(format!("{name}.wasm")))
}

/// Compiler flags that shorten the paths of sources. Where several fit, the compiler takes the last.
fn short_paths() -> Vec<String> {
    let mut flags = vec![format!("--remap-path-prefix={}/=", machine::root().display())];
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| env::home_dir().map(|home| home.join(".cargo")));
    let registries = home.and_then(|home| fs::read_dir(home.join("registry/src")).ok());
    for registry in registries.into_iter().flatten().flatten() {
        flags.push(format!("--remap-path-prefix={}/=", registry.path().display()));
    }
    flags
}

/// What wasm-bindgen makes of the compiled program.
struct Bound {
    wasm: Vec<u8>,
    glue: String,
}

fn bind(compiled: &Path, symbols: bool) -> Result<Bound> {
    let mut output = Bindgen::new()
        .input_path(compiled)
        .web(true)?
        .typescript(false)
        .omit_default_module_path(true)
        .remove_name_section(!symbols)
        .remove_producers_section(true)
        .generate_output()
        .context("wasm-bindgen")?;
    ensure!(
        output.local_modules().is_empty() && output.snippets().values().all(Vec::is_empty),
        "a library brings JavaScript of its own, which this build cannot put into the one script"
    );
    let mut glue = output.js().to_owned();
    let wasm = output.wasm_mut();
    // The generated names carry hashes, which do not compress. Both sides get the same shorter names.
    let imported = wasm.imports.iter_mut().map(|import| &mut import.name);
    let exported = wasm.exports.iter_mut().map(|export| &mut export.name);
    let called = exported.filter(|name| name.starts_with("wasm_bindgen__"));
    glue = shorten(&glue, imported.chain(called).collect());
    // wasm-bindgen has read them, and a browser does not need them.
    for section in ["target_features", "__wasm_split_unstable"] {
        wasm.customs.remove_raw(section);
    }
    Ok(Bound { wasm: wasm.emit_wasm(), glue })
}

/// Gives names that stand in a script and in its program shorter forms.
fn shorten(glue: &str, mut names: Vec<&mut String>) -> String {
    // A name that another one begins with comes after it.
    names.sort_by_key(|name| std::cmp::Reverse(name.len()));
    names.into_iter().enumerate().fold(glue.to_owned(), |glue, (number, name)| {
        let short = format!("${number}");
        let glue = glue.replace(name.as_str(), &short);
        *name = short;
        glue
    })
}

/// A file of the site.
struct File {
    name: String,
    bytes: Vec<u8>,
}

impl File {
    /// A file whose name changes with its content.
    fn named(stem: &str, extension: &str, bytes: Vec<u8>) -> Self {
        let mut name = format!("{stem}-");
        for byte in &Sha256::digest(&bytes)[..5] {
            let _ = write!(name, "{byte:02x}");
        }
        Self { name: format!("{name}.{extension}"), bytes }
    }
}

/// The files of a site.
struct Site {
    /// What a visitor loads at once; the page first.
    first: Vec<File>,
    /// What is loaded when it is needed.
    later: Vec<File>,
}

/// All files. Each file's name is put into the files that refer to it.
fn assemble(page: &Bound, workbench: &Bound, simulator: &Bound, analyst: &Bound) -> Result<Site> {
    let root = machine::root();
    let source = |path: &str| fs::read_to_string(root.join(path)).with_context(|| format!("cannot read {path}"));
    let named = |stem, extension, bytes| File::named(stem, extension, bytes);
    let analyst_wasm = named("buslens-analyst", "wasm", analyst.wasm.clone());
    let script = replace(&script(&analyst.glue, &source("analyst/boot.js")?)?, "\"analyst.wasm\"", &analyst_wasm.name)?;
    let analyst_script = named("buslens-analyst", "js", minify::js(&script).into_bytes());
    let (first_styles, workbench_styles) = styles(&root.join("style"))?;
    let workbench_style = named("buslens-workbench", "css", minify::css(&workbench_styles).into_bytes());
    let workbench_wasm = named("buslens-workbench", "wasm", workbench.wasm.clone());
    let script = self::script(&workbench.glue, &source("src/bin/buslens-workbench.js")?)?;
    let script = replace(&script, "\"workbench.wasm\"", &workbench_wasm.name)?;
    let script = replace(&script, "\"workbench.css\"", &workbench_style.name)?;
    let workbench_script = named("buslens-workbench", "js", minify::js(&script).into_bytes());
    let simulator_wasm = named("buslens-simulator", "wasm", simulator.wasm.clone());
    let script = self::script(&simulator.glue, &source("src/bin/buslens-simulator.js")?)?;
    let script = replace(&script, "\"simulator.wasm\"", &simulator_wasm.name)?;
    let simulator_script = named("buslens-simulator", "js", minify::js(&script).into_bytes());
    let wasm = named("buslens", "wasm", page.wasm.clone());
    let script = replace(&self::script(&page.glue, &source("src/boot.js")?)?, "\"buslens.wasm\"", &wasm.name)?;
    let script = replace(&script, "\"analyst.js\"", &analyst_script.name)?;
    let script = replace(&script, "\"workbench.js\"", &workbench_script.name)?;
    let script = replace(&script, "\"simulator.js\"", &simulator_script.name)?;
    let script = named("buslens", "js", minify::js(&script).into_bytes());
    let style = named("buslens", "css", minify::css(&first_styles).into_bytes());
    let icon = named("buslens", "svg", source("icon.svg")?.into_bytes());
    let mut page = source("index.html")?;
    for (plain, file) in
        [("\"buslens.wasm\"", &wasm), ("\"buslens.js\"", &script), ("\"buslens.css\"", &style), ("\"icon.svg\"", &icon)]
    {
        page = replace(&page, plain, &file.name)?;
    }
    let page = File { name: "index.html".to_owned(), bytes: page.into_bytes() };
    let later = vec![
        workbench_script,
        workbench_wasm,
        workbench_style,
        simulator_script,
        simulator_wasm,
        analyst_script,
        analyst_wasm,
    ];
    Ok(Site { first: vec![page, script, wasm, style, icon], later })
}

/// The one script of window and worker: the generated bindings, which nobody imports any more, and what starts them.
fn script(glue: &str, boot: &str) -> Result<String> {
    let export = "export { initSync, __wbg_init as default };";
    ensure!(glue.matches(export).count() == 1, "wasm-bindgen's output has another form than this build knows");
    Ok(glue.replace(export, "const start = __wbg_init;") + boot)
}

/// Replaces the only occurrence of a quoted name.
fn replace(text: &str, quoted: &str, name: &str) -> Result<String> {
    ensure!(
        text.matches(quoted).count() == 1,
        "{quoted} should stand once in the page or the script that refers to it"
    );
    Ok(text.replace(quoted, &format!("\"{name}\"")))
}

/// Style sheets of what only the workbench draws.
const WORKBENCH_STYLES: [&str; 12] = [
    "builder",
    "bytes",
    "configure",
    "console",
    "decoder",
    "fleet",
    "handling",
    "help",
    "list",
    "profiles",
    "sequence",
    "sheet",
];

/// The style sheets of the first program and of the workbench: the design's tokens first, the others in the order of their
/// names.
fn styles(folder: &Path) -> Result<(String, String)> {
    let entries = fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "css"));
    paths.sort_by_key(|path| (path.file_stem().is_some_and(|stem| stem != "tokens"), path.clone()));
    let (mut first, mut workbench) = (String::new(), String::new());
    for path in paths {
        let of_workbench = path.file_stem().is_some_and(|stem| WORKBENCH_STYLES.iter().any(|name| stem == *name));
        let all = if of_workbench { &mut workbench } else { &mut first };
        *all += &fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        all.push('\n');
    }
    Ok((first, workbench))
}

/// A file with its compressed forms.
struct Packed {
    file: File,
    gzip: Vec<u8>,
    brotli: Vec<u8>,
}

impl Packed {
    fn new(file: File, quick: bool) -> Result<Self> {
        let (level, quality) = if quick { (Compression::fast(), 1) } else { (Compression::best(), 11) };
        let mut gzip = GzEncoder::new(Vec::new(), level);
        gzip.write_all(&file.bytes)?;
        let mut brotli = Vec::new();
        let params = BrotliEncoderParams { quality, lgwin: 22, size_hint: file.bytes.len(), ..Default::default() };
        brotli::BrotliCompress(&mut file.bytes.as_slice(), &mut brotli, &params)?;
        Ok(Self { gzip: gzip.finish()?, brotli, file })
    }
}

/// Writes beside `folder` first, so that nobody is served half a site.
fn write<'a>(files: impl Iterator<Item = &'a Packed>, folder: &Path) -> Result<()> {
    let fresh = machine::root().join(format!("target/site-{}", process::id()));
    fs::create_dir_all(&fresh)?;
    let put = |name: &str, bytes: &[u8]| {
        let path = fresh.join(name);
        fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))
    };
    let mut paths = Vec::new();
    for Packed { file, gzip, brotli } in files {
        put(&file.name, &file.bytes)?;
        put(&format!("{}.gz", file.name), gzip)?;
        put(&format!("{}.br", file.name), brotli)?;
        paths.push(format!("/{}", file.name));
    }
    put("_headers", headers::file(paths.iter().map(String::as_str)).as_bytes())?;
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot replace {}", folder.display()))?;
    }
    fs::rename(&fresh, folder).with_context(|| format!("cannot write {}", folder.display()))
}

fn table(first: &[Packed], later: &[Packed]) -> String {
    let mut text = format!("{:<36}{:>10}{:>10}{:>10}\n", "file (bytes)", "raw", "gzip", "brotli");
    for (files, sum_name) in [(first, "first load"), (later, "on demand")] {
        let mut sum = [0; 3];
        let mut row = |name: &str, sizes: [usize; 3]| {
            let _ = writeln!(text, "{name:<36}{:>10}{:>10}{:>10}", sizes[0], sizes[1], sizes[2]);
        };
        for Packed { file, gzip, brotli } in files {
            let sizes = [file.bytes.len(), gzip.len(), brotli.len()];
            row(&file.name, sizes);
            for (sum, size) in sum.iter_mut().zip(sizes) {
                *sum += size;
            }
        }
        row(sum_name, sum);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bindgen_is_the_one_that_the_app_is_compiled_with() {
        let lock = fs::read_to_string(machine::root().join("Cargo.lock")).unwrap();
        let version = |package: &str| {
            let name = format!("name = \"{package}\"");
            let mut lines = lock.lines().skip_while(|line| *line != name).skip(1);
            lines.next().and_then(|line| line.strip_prefix("version = ")).map(str::to_owned).unwrap()
        };
        assert_eq!(version("wasm-bindgen"), version("wasm-bindgen-cli-support"));
    }

    #[test]
    fn heavier_than_the_budget_is_refused() {
        assert!(FirstLoad { bytes: BUDGET, budget: BUDGET }.check().is_ok());
        assert!(FirstLoad { bytes: BUDGET + 1, budget: BUDGET }.check().is_err());
    }

    #[test]
    fn name_changes_with_the_content() {
        let name = |text: &str| File::named("buslens", "js", text.into()).name;
        assert_eq!(name("a"), name("a"));
        assert_ne!(name("a"), name("b"));
        assert_eq!(name("a").split_once('-').map(|parts| parts.0), Some("buslens"));
    }

    #[test]
    fn script_binds_boot_to_the_glue() {
        let script = script("let x;\nexport { initSync, __wbg_init as default };\n", "await start();").unwrap();
        assert_eq!(script, "let x;\nconst start = __wbg_init;\nawait start();");
        assert!(super::script("let x;", "").is_err());
    }

    #[test]
    fn names_are_shortened_on_both_sides_whatever_they_begin_with() {
        let (mut short, mut long) = ("get_1".to_owned(), "get_1_2".to_owned());
        let glue = shorten("get_1: f, get_1_2: wasm.get_1", vec![&mut short, &mut long]);
        assert_eq!((glue.as_str(), short.as_str(), long.as_str()), ("$1: f, $0: wasm.$1", "$1", "$0"));
    }

    #[test]
    fn a_name_that_is_missing_or_double_is_refused() {
        assert_eq!(replace("src=\"a\"", "\"a\"", "b").unwrap(), "src=\"b\"");
        assert!(replace("", "\"a\"", "b").is_err());
        assert!(replace("\"a\"\"a\"", "\"a\"", "b").is_err());
    }

    #[test]
    fn packed_forms_unpack_to_the_same() {
        let bytes = b"every byte counts, every byte counts".to_vec();
        let packed = Packed::new(File::named("buslens", "css", bytes.clone()), false).unwrap();
        let mut unpacked = Vec::new();
        brotli::BrotliDecompress(&mut packed.brotli.as_slice(), &mut unpacked).unwrap();
        assert_eq!(unpacked, bytes);
        let mut unpacked = Vec::new();
        std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(packed.gzip.as_slice()), &mut unpacked).unwrap();
        assert_eq!(unpacked, bytes);
    }
}
