//! Samples as Radiance scene files.

use super::*;
use crate::error::Error;
use crate::geometry::{Shape, Vec3};

const PLASTIC: &str = "void plastic grey 0 0 5 .5 .5 .5 0 0\n";

fn with(files: &[(&str, &str)], text: &str) -> Result<Radiance> {
    parse(text.as_bytes(), 1.0, &mut |name| {
        let found = files.iter().find(|(n, _)| *n == name);
        found
            .map(|(_, t)| t.as_bytes().to_vec())
            .ok_or_else(|| Error::Io(format!("{name}: not found")))
    })
}

fn told(text: &str) -> String {
    with(&[], text).expect_err("a fault").to_string()
}

#[test]
fn shapes_come_with_their_materials_in_metres() {
    let text = "# a comment\nvoid glass clear 0 0 3 .9 .9 .9 grey_not_used\n";
    assert!(with(&[], text).is_err());
    let text = "void glass clear 0 0 3 .9 .9 .9\nvoid alias pane clear
        pane polygon p 0 0 12 0 0 0  10 0 0  10 10 0  0 10 0
        clear sphere s 0 0 4 1 2 3 4
        clear bubble b 0 0 4 1 2 3 4
        clear ring r 0 0 8 0 0 0 0 0 -5 2 1
        clear cylinder c 0 0 7 0 0 0 1 0 0 .5
        clear cup k 0 0 8 0 0 0 1 0 0 .5 0";
    let read = parse(text.as_bytes(), 0.001, &mut |_| unreachable!()).unwrap();
    assert_eq!(read.scene.surfaces, ["pane", "clear"]);
    assert_eq!(read.materials[1].numbers, [0.9; 3]);
    assert_eq!(read.materials[0].metres_per_unit, 0.001);
    assert_eq!(read.scene.objects, ["p", "s", "b", "r", "c", "k"]);
    let shapes: Vec<Shape> = read.scene.elements.iter().map(|e| e.shape).collect();
    assert_eq!(shapes.len(), 7);
    let close = |a: Vec3, x: f64, y: f64, z: f64| (a - Vec3::new(x, y, z)).length() < 1e-18;
    let Shape::Triangle([a, b, c]) = shapes[0] else {
        panic!("a triangle")
    };
    assert!(((b - a).cross(c - a) - Vec3::new(0.0, 0.0, 1e-4)).length() < 1e-18);
    assert!(matches!(shapes[2], Shape::Sphere { centre, radius, inward: false }
        if close(centre, 0.001, 0.002, 0.003) && (radius - 0.004).abs() < 1e-18));
    assert!(matches!(shapes[3], Shape::Sphere { inward: true, .. }));
    assert!(matches!(shapes[4], Shape::Ring { normal, radii, .. }
        if normal == Vec3::new(0.0, 0.0, -1.0) && radii[0] < radii[1]));
    assert!(matches!(shapes[5], Shape::Cone { radii: [a, b], inward: false, .. } if a == b));
    assert!(matches!(
        shapes[6],
        Shape::Cone {
            radii: [_, 0.0],
            inward: true,
            ..
        }
    ));
}

#[test]
fn arrays_of_files_are_where_xform_puts_them() {
    let slat = "grey polygon slat 0 0 9 0 0 0 1 0 0 0 0 1\n!xform -n in -t 0 0 7 part.rad\n";
    let part = "grey sphere ball 0 0 4 1 0 0 .25\n";
    let text = format!("{PLASTIC}!xform -n s -mx -a 3 -t 0 2 0 -i 1 -s 10 \\\n slat.rad");
    let read = with(&[("slat.rad", slat), ("part.rad", part)], &text).unwrap();
    assert_eq!(read.materials.len(), 1);
    assert_eq!(read.scene.objects[2..4], ["s.1.slat", "s.1.in.ball"]);
    let Shape::Triangle([a, b, c]) = read.scene.elements[4].shape else {
        panic!("a triangle")
    };
    // Mirrored, so that the corners run the other way round.
    assert_eq!(c, Vec3::new(0.0, 40.0, 0.0));
    assert_eq!((a, b), (Vec3::new(0.0, 40.0, 10.0), Vec3::new(-10.0, 40.0, 0.0)));
    let Shape::Sphere { centre, radius, .. } = read.scene.elements[5].shape else {
        panic!("a sphere")
    };
    assert_eq!((centre, radius), (Vec3::new(-10.0, 40.0, 70.0), 2.5));
}

#[test]
fn modifiers_and_inversions_go_through_pipes() {
    let text = format!(
        "{PLASTIC}void metal steel 0 0 5 .5 .5 .5 .9 0\n!genbox grey b 1 1 1 | xform -m steel -I | xform -m grey -t 5 0 0\n"
    );
    let read = with(&[], &text).unwrap();
    assert_eq!(read.scene.surfaces, ["grey"]);
    let six: f64 = (read.scene.elements.iter())
        .map(|e| match e.shape {
            Shape::Triangle([a, b, c]) => a.dot(b.cross(c)),
            _ => 0.0,
        })
        .sum();
    assert!((six + 6.0).abs() < 1e-12, "{six}");
}

#[test]
fn later_definitions_hold_for_later_objects() {
    let ball = "grey sphere s 0 0 4 0 0 0 1\n";
    let again = "void plastic grey 0 0 5 .1 .1 .1 0 0\n";
    let read = with(&[], &format!("{PLASTIC}{ball}{again}{ball}{again}{ball}")).unwrap();
    assert_eq!(read.scene.surfaces, ["grey", "grey 2"]);
    let surfaces: Vec<u32> = read.scene.elements.iter().map(|e| e.surface).collect();
    assert_eq!(surfaces, [0, 1, 1]);
    assert_eq!(read.materials[1].numbers[0], 0.1);
}

#[test]
fn up_vectors_of_bsdfs_turn_with_their_file() {
    let film = "void BSDF film 6 0.1 film.xml 0 0 1 . 0 0\nfilm sphere s 0 0 4 0 0 0 1\n";
    let read = with(&[("film.rad", film)], "!xform -rx 90 -s 2 film.rad").unwrap();
    assert_eq!(read.materials[0].words, ["0.1", "film.xml", "0", "-1", "0", "."]);
    assert_eq!(read.materials[0].metres_per_unit, 2.0);
}

#[test]
fn a_bsdf_without_texts_is_handed_on() {
    let read = with(&[], "void BSDF film 0 0 0\nfilm sphere s 0 0 4 0 0 0 1\n").unwrap();
    assert!(read.materials[0].words.is_empty());
}

#[test]
fn what_does_not_matter_is_left_out() {
    let text = format!(
        "void light l 0 0 3 1 1 1\nl source sun 0 0 4 0 0 1 .5\nvoid colorfunc p 4 a b c d 0 0\np plastic q 0 0 5 1 1 1 0 0\n\
         {PLASTIC}grey sphere s 0 0 4 0 0 0 1"
    );
    let read = with(&[], &text).unwrap();
    assert_eq!(read.scene.warnings.len(), 1);
    assert!(read.scene.warnings[0].contains("type source"));
}

#[test]
fn faults_are_told_in_one_line_with_their_place() {
    for (text, part) in [
        (
            "grey sphere s 0 0 4 0 0 0 1",
            "line 1: sphere \"s\": its material \"grey\" is not defined above it",
        ),
        ("void sphere s 0 0 4 0 0 0 1", "no material"),
        (
            "void glow g 0 0 4 1 1 1 0\ng sphere s 0 0 4 0 0 0 1",
            "line 2: sphere \"s\": its material \"g\" is of type \"glow\"",
        ),
        ("void antimatter a 1 x 0 0\na sphere s 0 0 4 0 0 0 1", "\"antimatter\""),
        (
            "void brightfunc f 2 a b 0 0\nf plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 4 0 0 0 1",
            "patterns and textures",
        ),
        (
            "void plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 4 0 0 0 -1",
            "a radius of -1",
        ),
        (
            "void plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 3 0 0 0",
            "3 real arguments, not 4",
        ),
        (
            "void plastic p 0 0 5 1 1 1 0 0\np polygon s 0 0 7 0 0 0 1 1 1 2",
            "not three a corner",
        ),
        (
            "void plastic p 0 0 5 1 1 1 0 0\np ring s 0 0 8 0 0 0 0 0 0 1 2",
            "a direction of 0 0 0",
        ),
        (
            "void plastic p 0 0 5 1 1 1 0 0\np cone s 0 0 8 0 0 0 0 0 0 1 2",
            "both ends at",
        ),
        (
            "void plastic p 0 0 5 1 1 x 0 0",
            "line 1: \"x\" stands where a real argument should be",
        ),
        (
            "void plastic p 0 0 99999999999 1",
            "the file ends where a real argument should be",
        ),
        ("void plastic", "the file ends where a name should be"),
        ("p instance i 1 a.oct 0 0", "a compiled octree, \"a.oct\""),
        ("p mesh i 1 a.rtm 0 0", "a compiled mesh, \"a.rtm\""),
        ("void alias a b", "alias \"a\" stands for \"b\""),
        ("\n!xform -t 1 0 0 none.rad", "line 2: none.rad: not found"),
        ("!gensky 6 21 12", "the command \"gensky\""),
    ] {
        let error = told(text);
        assert!(error.contains(part) && !error.contains('\n'), "{text}: {error}");
    }
    let inner = with(&[("a.rad", "\n\nbad sphere s 0 0 4 0 0 0 1")], "!xform -t 0 0 1 a.rad").unwrap_err();
    assert!(inner.to_string().starts_with("a.rad, line 3: sphere"), "{inner}");
    let round = with(&[("a.rad", "!xform -t 0 0 1 a.rad")], "!xform -t 0 0 1 a.rad").unwrap_err();
    assert!(round.to_string().contains("32 deep"), "{round}");
    let many = "!xform -a 1000 -t 1 0 0 b.rad";
    let bomb = with(
        &[
            ("a.rad", many),
            ("b.rad", &many.replace("b.rad", "c.rad")),
            ("c.rad", &"#".repeat(100_000)),
        ],
        "!xform -a 9 a.rad",
    );
    assert!(bomb.unwrap_err().to_string().contains("again and again"));
}
