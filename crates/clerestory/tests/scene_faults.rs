//! Faulty scene files: whatever is changed in a sound one, the readers give a scene or one line that says what is wrong.

use clerestory::error::{Error, Result};
use clerestory::geometry::{Extent, Mesh, Scene};
use clerestory::io::{mtl, obj, ply, radiance, stl};
use proptest::prelude::*;

const RAD: &str = "# blind\nvoid plastic grey 0 0 5 .5 .5 .5 .02 .05\nvoid alias matt grey\n\
    matt polygon slat 0 0 12 0 0 0 1 0 0 1 1 .1 0 1 .1\ngrey cone c 0 0 8 0 0 0 0 0 1 .1 .2\n\
    grey ring r 0 0 8 0 0 0 0 0 1 0 .1\n!genblinds grey bl .08 1 2 3 30 +r .1 | xform -n b -a 2 -t 0 0 1\n\
    !genprism matt p 3 0 0 1 0 0 1 -l 0 0 2\n!xform -m matt -rx 30 -a 2 -t 1 0 0 -i 3 -s 2 part.rad\n\
    void BSDF film 6 0 f.xml 0 0 1 . 0 0\nfilm sphere s 0 0 4 0 0 0 1\n";
const PART: &str = "grey bubble b 0 0 4 1 2 3 .5\n!genbox grey box 1 2 3\n";
const OBJ: &str = "mtllib a.mtl\no film\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng a\nf 1/1 2/2 3/3 4/4\nusemtl m\nf -4 -2 -1\n\
    v 2 0.5 0\nf 1 2 5 3 4\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
const PLY: &str = "comment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
    property list uchar int vertex_indices\nend_header\n";

const ROOM: &str = "void glow g 0 0 4 1 2 3 6\ng sphere s 0 0 4 0 0 0 1\nvoid spotlight l 0 0 7 9 8 7 60 1 0 -2\n\
    l ring r 0 0 8 0 0 0 0 0 -1 0 .2\nvoid aBSDF film 7 f.xml 0 0 1 . -rz 9 0 3 .1 .2 .3\n\
    film polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\nvoid light solar 0 0 3 7 7 7\nsolar source sun 0 0 4 0 0 1 .5\n\
    void brightfunc skyfunc 4 skybr skybright.cal -rz 3 0 7 1 2 3 1 0 0 1\nskyfunc glow d 0 0 4 1 1 1 0\n\
    d source sky 0 0 4 0 0 1 180\n!gensky 6 21 10:30EST +i -m 75 -g .3 | xform -rz 20\n\
    !gendaylit -ang 30 10 -W 706 162 -O 1\nskyfunc glow e 0 0 4 1 1 1 0\ne source sky 0 0 4 0 0 -1 180\n\
    void illum i 1 void 0 3 1 1 1\n!genbox i b 1 1 1\n";
const MTL: &str =
    "newmtl wall\nKd .5 .4 .3\nKs .1\nNs 20\nillum 2\nmap_Kd a.png\nnewmtl pane\nKd 0 0 0\nd .2\nTf 1 1 .9\n";

fn stl_binary() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(2_u32.to_le_bytes());
    for shift in [0.0_f32, 1.0] {
        for x in [0.0, 0.0, 1.0, shift, 0.0, 0.0, 1.0, shift, 0.0, 0.0, 1.0, 0.5] {
            bytes.extend(x.to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}

fn ply_text() -> Vec<u8> {
    format!("ply\nformat ascii 1.0\n{PLY}0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n").into_bytes()
}

fn ply_binary() -> Vec<u8> {
    let mut bytes = format!("ply\nformat binary_little_endian 1.0\n{PLY}").into_bytes();
    for [x, y] in [[0.0_f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
        bytes.extend([x, y, 0.0].into_iter().flat_map(f32::to_le_bytes));
    }
    for face in [&[0_i32, 1, 2][..], &[0, 1, 2, 3]] {
        bytes.push(face.len() as u8);
        bytes.extend(face.iter().flat_map(|k| k.to_le_bytes()));
    }
    bytes
}

fn rad(bytes: &[u8]) -> Result<Scene> {
    let read = radiance::parse(bytes, 0.01, &mut |name| match name {
        "part.rad" => Ok(PART.as_bytes().to_vec()),
        _ => Err(Error::Io(format!("{name}: not found"))),
    })?;
    assert_eq!(read.scene.surfaces.len(), read.materials.len());
    Ok(read.scene)
}

fn room(bytes: &[u8]) -> Result<Scene> {
    let mut open = |name: &str| Err(Error::Io(format!("{name}: not found")));
    let read = radiance::parse_room(bytes, "", 0.01, &mut open, &|_| None)?;
    assert_eq!(read.scene.surfaces.len(), read.materials.len());
    let sound = |surface: u32| (surface as usize) < read.materials.len();
    assert!(read.polygons.iter().all(|p| sound(p.surface)));
    assert!(read.lights.iter().all(|l| sound(l.surface)));
    assert!(read.data_sets.iter().all(|s| sound(s.surface)));
    assert!(
        read.sources
            .iter()
            .all(|s| s.sky.is_none_or(|sky| sky < read.skies.len()) && s.direction.x.is_finite())
    );
    Ok(read.scene)
}

fn library(bytes: &[u8]) -> Result<Scene> {
    let (materials, _) = mtl::parse(bytes, "a.mtl")?;
    let shares = materials.iter().flat_map(|m| &m.numbers[..4]);
    assert!(shares.into_iter().all(|v| (0.0..=1.0).contains(v)));
    Ok(Scene::default())
}

/// Reads what may be faulty; a scene that comes out is made ready for rays as well, if it is small.
fn survives(read: fn(&[u8]) -> Result<Scene>, bytes: &[u8]) {
    let one_line = |error: &Error| {
        let text = error.to_string();
        assert!(!text.is_empty() && !text.contains('\n'), "{text:?}");
    };
    match read(bytes) {
        Ok(scene) if scene.elements.len() < 1000 => {
            assert!(
                scene
                    .elements
                    .iter()
                    .all(|e| (e.surface as usize) < scene.surfaces.len())
            );
            assert!(scene.elements.iter().all(|e| (e.object as usize) < scene.objects.len()));
            let extent = Extent {
                limits: [0.0, 3.0],
                repeated: true,
            };
            if let Err(error) = Mesh::new(scene, [extent; 2]) {
                one_line(&error);
            }
        }
        Ok(_) => {}
        Err(error) => one_line(&error),
    }
}

type Reader = fn(&[u8]) -> Result<Scene>;

fn samples() -> Vec<(Reader, Vec<u8>)> {
    vec![
        (rad as Reader, RAD.as_bytes().to_vec()),
        (room, ROOM.as_bytes().to_vec()),
        (library, MTL.as_bytes().to_vec()),
        (|b| obj::parse(b, 1.0), OBJ.as_bytes().to_vec()),
        (|b| stl::parse(b, 1.0), STL.as_bytes().to_vec()),
        (|b| stl::parse(b, 1.0), stl_binary()),
        (|b| ply::parse(b, 1.0), ply_text()),
        (|b| ply::parse(b, 1.0), ply_binary()),
    ]
}

#[test]
fn the_sound_files_are_sound() {
    let counts: Vec<usize> = samples()
        .into_iter()
        .map(|(read, bytes)| read(&bytes).expect("sound").elements.len())
        .collect();
    // Slat, cone, ring, two blinds of three slats of sixteen quadrilaterals, prism, two copies of ball and box, sphere.
    assert_eq!(
        counts,
        [
            2 + 1 + 1 + 2 * 3 * 16 * 2 + 8 + 2 * 13 + 1,
            1 + 1 + 2 + 12,
            0,
            6,
            1,
            2,
            3,
            3
        ]
    );
}

/// What is done to a file: at a share of its length, some bytes go and others come.
fn change() -> impl Strategy<Value = (f64, usize, Vec<u8>)> {
    let words = prop::sample::select(vec![
        "nan",
        "-1",
        "1e308",
        "0",
        "99999999999",
        "\n",
        " ",
        "\"",
        "!",
        "|",
        "-a",
        "polygon",
        "\u{e9}",
        "",
    ]);
    let new = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..4),
        words.prop_map(|w| w.as_bytes().to_vec()),
    ];
    (0.0..1.0, 0_usize..12, new)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn changed_files_end_in_a_scene_or_in_one_line(changes in prop::collection::vec(change(), 1..4), cut in 0.0..2.0) {
        for (read, mut bytes) in samples() {
            for (at, gone, new) in &changes {
                let at = (at * bytes.len() as f64) as usize;
                let end = (at + gone).min(bytes.len());
                bytes.splice(at..end, new.iter().copied());
            }
            if cut < 1.0 {
                bytes.truncate((cut * bytes.len() as f64) as usize);
            }
            survives(read, &bytes);
        }
    }

    #[test]
    fn any_bytes_end_in_a_scene_or_in_one_line(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        for (read, _) in samples() {
            survives(read, &bytes);
        }
    }
}
