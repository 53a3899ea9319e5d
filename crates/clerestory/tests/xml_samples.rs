//! Real files of the field, where the sample data are: they all load, and give the values that their READMEs list.

use std::fs;
use std::path::{Path, PathBuf};

use clerestory::bsdf::{Bsdf, Model, Part, Scatterer};
use clerestory::direction::{Disk, Scatter, Side};
use clerestory::io::xml::{Hints, Target, read, write};

/// The folder of the sample data, by `CLERESTORY_DATA` or beside the repository.
fn samples() -> Option<PathBuf> {
    let folder = std::env::var_os("CLERESTORY_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    folder.join("klems").is_dir().then_some(folder)
}

/// Rows of the table in a README that has the given first heading, as cells.
fn table(readme: &Path, second_heading: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(readme).unwrap();
    let mut rows = text
        .lines()
        .skip_while(|l| !l.contains(second_heading))
        .take_while(|l| l.starts_with('|'))
        .map(|l| l.split('|').skip(1).map(|c| c.trim().to_owned()).collect())
        .skip(2);
    let rows: Vec<Vec<String>> = rows.by_ref().collect();
    assert!(rows.len() > 5, "{}", readme.display());
    rows
}

fn direction(code: &str) -> (Side, Scatter) {
    let side = if code.ends_with('f') {
        Side::Exterior
    } else {
        Side::Interior
    };
    let scatter = if code.starts_with('T') {
        Scatter::Transmission
    } else {
        Scatter::Reflection
    };
    (side, scatter)
}

#[test]
fn klems_files_give_the_listed_values() {
    let Some(folder) = samples() else {
        eprintln!("skipped: no sample data");
        return;
    };
    let klems = folder.join("klems");
    let mut blocks = 0;
    for row in table(&klems.join("README.md"), "well-formed XML") {
        let name = &row[0];
        if name.starts_with("mini/") {
            continue;
        }
        let bytes = fs::read(klems.join(name)).unwrap();
        let bsdf = read(&bytes, &Hints::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut listed = 0;
        for cell in row[4].split(';') {
            let words: Vec<&str> = cell.split_whitespace().collect();
            let band = if words[0].to_lowercase().starts_with('s') {
                "solar"
            } else {
                "visible"
            };
            let (side, scatter) = direction(words[1]);
            let first: f64 = words[2].parse().unwrap();
            let most: f64 = words[3].trim_matches(['(', ')']).parse().unwrap();
            let component = bsdf.band(Some(band)).unwrap().get(side, scatter).unwrap().clone();
            let Model::Matrix(matrix) = &*component else {
                panic!("{name}: {}", component.kind())
            };
            let values: Vec<f64> = (0..matrix.incident().len())
                .map(|i| matrix.direct_hemispherical(i))
                .collect();
            assert!((values[0] - first).abs() < 6e-5, "{name} {cell}: {}", values[0]);
            let largest = values.iter().copied().fold(0.0, f64::max);
            assert!((largest - most).abs() < 6e-4, "{name} {cell}: {largest}");
            listed += 1;
        }
        let held: usize = bsdf.bands().iter().map(|b| b.components().count()).sum();
        assert_eq!(held, listed, "{name}");
        blocks += held;
    }
    assert!(blocks > 80, "{blocks}");
}

#[test]
fn tree_files_give_the_listed_values() {
    let Some(folder) = samples() else {
        eprintln!("skipped: no sample data");
        return;
    };
    let trees = folder.join("tensortree");
    for row in table(&trees.join("README.md"), "structure") {
        let name = &row[0];
        let bytes = fs::read(trees.join(name)).unwrap();
        let bsdf = read(&bytes, &Hints::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        let band = bsdf.band(None).unwrap();
        let columns = [
            (Side::Interior, Scatter::Transmission),
            (Side::Exterior, Scatter::Transmission),
            (Side::Interior, Scatter::Reflection),
            (Side::Exterior, Scatter::Reflection),
        ];
        for (cell, (side, scatter)) in row[4..8].iter().zip(columns) {
            let expected: f64 = cell.parse().unwrap();
            let Some(component) = band.get(side, scatter) else {
                continue;
            };
            // Normal incidence is a corner of four cells of a tree; any of them may have answered.
            let values = [(1, 1), (1, -1), (-1, 1), (-1, -1)].map(|(x, y)| {
                let point = Disk::new(1e-6 * f64::from(x), 1e-6 * f64::from(y));
                component.total(point, Part::All).value
            });
            let fits = values.iter().any(|v| (v - expected).abs() <= 5e-3 * expected + 6e-5);
            assert!(fits, "{name} {side:?} {scatter:?}: {values:?} {expected}");
        }
    }
}

#[test]
fn parser_tests_with_four_numbers_are_refused() {
    let Some(folder) = samples() else {
        eprintln!("skipped: no sample data");
        return;
    };
    let mut seen = 0;
    for entry in fs::read_dir(folder.join("klems/mini")).unwrap() {
        let bytes = fs::read(entry.unwrap().path()).unwrap();
        let error = read(&bytes, &Hints::default()).unwrap_err().to_string();
        assert!(error.contains("4 values where 145 × 145 = 21025 belong"), "{error}");
        seen += 1;
    }
    assert_eq!(seen, 3);
}

#[test]
fn faults_of_real_files_are_named() {
    let Some(folder) = samples() else {
        eprintln!("skipped: no sample data");
        return;
    };
    for (name, fault) in [
        (
            "tutorial_blinds_with_log_line.xml",
            "line 1: text stands before the XML",
        ),
        ("CS-TBK7-12_112916.xml.gz", "written \"solar\" instead of \"Solar\""),
        ("blinds30.xml", "label of the wrong direction"),
        (
            "ec60.xml",
            "Reflection Back of band \"solar\" is the same, value for value, as Transmission Front",
        ),
    ] {
        let bytes = fs::read(folder.join("klems").join(name)).unwrap();
        let warnings = read(&bytes, &Hints::default()).unwrap().warnings;
        assert!(warnings.iter().any(|w| w.contains(fault)), "{name}: {warnings:?}");
    }
}

#[test]
fn writing_and_reading_again_loses_nothing() {
    let Some(folder) = samples() else {
        eprintln!("skipped: no sample data");
        return;
    };
    let mut seen = 0;
    for kind in ["klems", "tensortree"] {
        for entry in fs::read_dir(folder.join(kind)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().to_lowercase();
            if !(name.ends_with(".xml") || name.ends_with(".xml.gz")) {
                continue;
            }
            let first = read(&fs::read(&path).unwrap(), &Hints::default()).unwrap();
            let (written, notes) = write(&first, Target::Plain).unwrap();
            assert_eq!(notes, Vec::<String>::new(), "{name}");
            let second = read(&written, &Hints::default()).unwrap();
            assert_eq!(second.metadata, first.metadata, "{name}");
            assert_same_models(&first, &second, &name);
            assert_eq!(write(&second, Target::Plain).unwrap().0, written, "{name}");
            let remaining: Vec<&String> = second
                .warnings
                .iter()
                .filter(|w| !w.contains("negative") && !w.contains("value for value"))
                .collect();
            assert!(remaining.is_empty(), "{name}: {remaining:?}");
            seen += 1;
        }
    }
    assert!(seen > 30, "{seen}");
}

fn assert_same_models(a: &Bsdf, b: &Bsdf, name: &str) {
    let described = |bsdf: &Bsdf| -> Vec<String> {
        bsdf.bands()
            .iter()
            .map(|b| format!("{} {:?} {:?}", b.name, b.source_spectrum, b.detector_spectrum))
            .collect()
    };
    assert_eq!(described(a), described(b), "{name}");
    for (x, y) in a.bands().iter().zip(b.bands()) {
        for side in Side::BOTH {
            for scatter in Scatter::BOTH {
                match (x.get(side, scatter).map(|m| &**m), y.get(side, scatter).map(|m| &**m)) {
                    (None, None) => {}
                    (Some(Model::Matrix(m)), Some(Model::Matrix(n))) => {
                        assert!(m == n, "{name} {} {side:?} {scatter:?}", x.name);
                        assert_eq!(m.incident().name(), n.incident().name());
                        assert_eq!(m.outgoing().name(), n.outgoing().name());
                    }
                    (Some(Model::Tree(m)), Some(Model::Tree(n))) => assert!(m == n, "{name}"),
                    _ => panic!("{name} {} {side:?} {scatter:?} differ in kind", x.name),
                }
            }
        }
    }
}
