//! Faulty files: each ends in one error or in warnings that name the fault, and nothing that a file can hold makes the
//! reader panic.

use std::fs;
use std::io::Read;
use std::path::Path;

use clerestory::bsdf::Model;
use clerestory::error::Error;
use clerestory::io::gzip::deflate;
use clerestory::io::xml::{Hints, Target, read, write};
use flate2::read::GzDecoder;
use proptest::prelude::*;

fn corpus() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus/xml")
}

/// Name, kind and message of each file of the corpus.
fn index() -> Vec<[String; 3]> {
    let text = fs::read_to_string(corpus().join("index.txt")).unwrap();
    text.lines()
        .filter(|l| !l.starts_with('#'))
        .map(|l| {
            let mut parts = l.splitn(3, '\t').map(str::to_owned);
            [(); 3].map(|()| parts.next().unwrap())
        })
        .collect()
}

#[test]
fn every_file_of_the_corpus_is_told_as_listed() {
    let mut failures = Vec::new();
    for [name, kind, message] in index() {
        let bytes = fs::read(corpus().join(&name)).unwrap();
        let told = match (kind.as_str(), read(&bytes, &Hints::default())) {
            ("error", Err(error)) => {
                let text = error.to_string();
                let Error::Format { place, remedy, .. } = error else {
                    panic!("{name}: {text} has no place")
                };
                let whole = text.contains(&message) && !text.contains('\n') && !remedy.is_empty();
                (whole && (place.starts_with("line ") || place == "gzip"), text)
            }
            ("warning", Ok(bsdf)) => (
                bsdf.warnings.len() == 1 && bsdf.warnings[0].contains(&message),
                bsdf.warnings.join(" / "),
            ),
            ("clean", Ok(bsdf)) => (bsdf.warnings.is_empty(), bsdf.warnings.join(" / ")),
            (_, Ok(_)) => (false, "it loads".into()),
            (_, Err(error)) => (false, error.to_string()),
        };
        if !told.0 {
            failures.push(format!("{name}: {kind} {message:?} was expected, not: {}", told.1));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn the_corpus_and_its_index_hold_the_same_files() {
    let mut listed: Vec<String> = index().into_iter().map(|[name, ..]| name).collect();
    listed.extend(["README.md", "index.txt", "make.py"].map(str::to_owned));
    let mut held: Vec<String> = fs::read_dir(corpus())
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .filter(|n| !n.starts_with('.') && n != "__pycache__")
        .collect();
    listed.sort();
    held.sort();
    assert_eq!(listed, held);
}

#[test]
fn harmless_oddities_do_not_change_the_values() {
    let values = |name: &str| {
        let bsdf = read(&fs::read(corpus().join(name)).unwrap(), &Hints::default()).unwrap();
        let band = bsdf.band(None).unwrap();
        let component = band.components().next().unwrap().2.clone();
        let Model::Matrix(matrix) = &*component else {
            panic!("{name}")
        };
        matrix.values().to_vec()
    };
    let good = values("good.xml.gz");
    for [name, kind, _] in index() {
        if kind == "clean" && name != "rows.xml" {
            assert_eq!(values(&name), good, "{name}");
        }
    }
    assert_ne!(values("rows.xml"), good);
}

/// What a mutation may do to a file.
#[derive(Debug, Clone)]
enum Change {
    Flip(usize, u8),
    Delete(usize, usize),
    Double(usize, usize),
    Cut(usize),
    Insert(usize, &'static str),
    Number(usize, &'static str),
}

fn change() -> impl Strategy<Value = Change> {
    let at = 0..4096_usize;
    let length = 1..200_usize;
    let text = prop::sample::select(vec![
        "<",
        ">",
        "&",
        "\"",
        "{",
        "}",
        ",",
        "<!--",
        "-->",
        "<![CDATA[",
        "]]>",
        "<a>",
        "</a>",
        "<a/>",
        "</",
        "<?",
        "&#0;",
        "\0",
        "\u{feff}",
        "<WindowElement>",
        "</Layer>",
        "<!DOCTYPE a>",
    ]);
    let number = prop::sample::select(vec![
        "NaN",
        "1e999",
        "-1",
        "1e300",
        "18446744073709551616",
        "-0",
        "0,5",
        "",
        "1e-400",
        "0x1",
        "999999",
        "{1}",
    ]);
    prop_oneof![
        (at.clone(), any::<u8>()).prop_map(|(k, b)| Change::Flip(k, b)),
        (at.clone(), length.clone()).prop_map(|(k, n)| Change::Delete(k, n)),
        (at.clone(), length).prop_map(|(k, n)| Change::Double(k, n)),
        at.clone().prop_map(Change::Cut),
        (at.clone(), text).prop_map(|(k, t)| Change::Insert(k, t)),
        (at, number).prop_map(|(k, t)| Change::Number(k, t)),
    ]
}

fn changed(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    for change in changes {
        if bytes.is_empty() {
            break;
        }
        let n = bytes.len();
        match *change {
            Change::Flip(k, with) => bytes[k % n] ^= with,
            Change::Delete(k, length) => drop(bytes.drain(k % n..(k % n + length).min(n))),
            Change::Double(k, length) => {
                let piece = bytes[k % n..(k % n + length).min(n)].to_vec();
                bytes.splice(k % n..k % n, piece);
            }
            Change::Cut(k) => bytes.truncate(k % n),
            Change::Insert(k, text) => drop(bytes.splice(k % n..k % n, text.bytes())),
            Change::Number(k, text) => {
                // The next number from there on.
                let is_digit = |c: &u8| c.is_ascii_digit() || *c == b'.';
                if let Some(from) = bytes[k % n..].iter().position(is_digit).map(|d| k % n + d) {
                    let to = bytes[from..].iter().position(|c| !is_digit(c)).map_or(n, |d| from + d);
                    bytes.splice(from..to, text.bytes());
                }
            }
        }
    }
    bytes
}

/// Reads; what loads must be written and read again with the same result.
fn survive(bytes: &[u8]) {
    let Ok(first) = read(bytes, &Hints::default()) else {
        return;
    };
    let (written, _) = write(&first, Target::Plain).expect("what was read can be written");
    let second = read(&written, &Hints::default()).expect("what was written can be read");
    assert_eq!(second.metadata, first.metadata);
    let (again, _) = write(&second, Target::Plain).unwrap();
    assert_eq!(again, written);
}

fn seeds() -> Vec<Vec<u8>> {
    index()
        .into_iter()
        .filter(|[name, kind, _]| kind != "error" && Path::new(name).extension().is_some_and(|e| e == "xml"))
        .map(|[name, ..]| fs::read(corpus().join(name)).unwrap())
        .collect()
}

/// 2,000 cases, or as many as the environment variable `PROPTEST_CASES` says.
fn config() -> ProptestConfig {
    let mut config = ProptestConfig::default();
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = 2000;
    }
    config.failure_persistence = None;
    config
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn changed_files_are_read_or_refused(
        seed in any::<prop::sample::Index>(),
        changes in prop::collection::vec(change(), 1..6),
    ) {
        let seeds = seeds();
        let bytes = changed(seeds[seed.index(seeds.len())].clone(), &changes);
        survive(&bytes);
        // Packed as well: the limits on what it may swell to hold for real files.
        if changes.len() == 1 {
            survive(&deflate(&bytes));
        }
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        survive(&bytes);
        let mut packed = deflate(&bytes);
        packed.extend(&bytes);
        survive(&packed);
    }
}

#[test]
fn a_bomb_of_blanks_is_refused_before_it_is_unpacked_whole() {
    // Valid XML all the way but for its end: 2 GB would follow, 72 MB are made here, in members that make up one file.
    let mut bomb = fs::read(corpus().join("good.xml.gz")).unwrap();
    let mut text = Vec::new();
    GzDecoder::new(bomb.as_slice()).read_to_end(&mut text).unwrap();
    let at = text.windows(7).position(|w| w == b"</Layer").unwrap();
    bomb = deflate(&text[..at]);
    bomb.extend(deflate(&vec![b' '; 8 << 20]).repeat(9));
    assert!(bomb.len() < 100_000);
    let error = read(&bomb, &Hints::default()).unwrap_err().to_string();
    assert!(error.contains("unpack to more than"), "{error}");
}

#[test]
fn a_huge_attribute_costs_no_more_than_itself() {
    let mut text = fs::read_to_string(corpus().join("no-namespace.xml")).unwrap();
    text = text.replace("<Name>", &format!("<Name a=\"{}\">", "x".repeat(8 << 20)));
    let bsdf = read(text.as_bytes(), &Hints::default()).unwrap();
    let material = bsdf.metadata.material.unwrap();
    assert_eq!(material.children[0].attribute("a").map(str::len), Some(8 << 20));
}
