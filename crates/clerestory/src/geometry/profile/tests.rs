//! Rays against sections of known answers.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::testing::{Numbers, arc, segment, slat, slow};
use super::*;

const SCALES: [f64; 3] = [50e-6, 1e-3, 2.0];

fn ray(origin: [f64; 2], direction: [f64; 2]) -> Ray {
    Ray {
        origin: Vec3::new(0.3, origin[1], origin[0]),
        direction: Vec3::new(0.0, direction[1], direction[0]).unit(),
        piece: NO_PIECE,
    }
}

fn hit(meeting: Meeting) -> Hit {
    match meeting {
        Meeting::Hit(hit) => hit,
        other => panic!("{other:?}"),
    }
}

#[test]
fn segments_are_met_where_geometry_says() {
    for scale in SCALES {
        let profile = Profile::new(slat(scale, 0.0, 0.0), scale).expect("sound");
        // From below: the front is up, so the back is met.
        let mut r = ray([0.25 * scale, -0.3 * scale], [0.0, 1.0]);
        let h = hit(profile.meet(&mut r));
        assert!((h.distance - 0.3 * scale).abs() < 1e-15 * scale);
        assert_eq!(h.normal, Vec3::new(0.0, 1.0, 0.0));
        assert!((r.origin - Vec3::new(0.3, 0.0, 0.25 * scale)).length() < 1e-15 * scale);
        // Onwards: the next copy, a period further, told in the first.
        let h = hit(profile.meet(&mut r));
        assert!((h.distance - scale).abs() < 1e-15 * scale && r.origin.y.abs() < 1e-15 * scale);
        // At 45 degrees from the outside through the gap.
        let mut r = ray([-0.6 * scale, 0.5 * scale], [1.0, 1.0]);
        let h = hit(profile.meet(&mut r));
        assert!((h.distance - 0.5 * scale * 2.0_f64.sqrt()).abs() < 1e-15 * scale);
        assert_eq!(profile.meet(&mut ray([0.6 * scale, 0.0], [1.0, 1.0])), Meeting::Leaves);
        // Level with the gap's middle: never.
        assert_eq!(
            profile.meet(&mut ray([-scale, 0.5 * scale], [1.0, 0.0])),
            Meeting::Leaves
        );
        assert_eq!(profile.meet(&mut ray([-scale, 0.5 * scale], [0.0, 1.0])), Meeting::Lost);
    }
}

#[test]
fn arcs_are_met_where_geometry_says() {
    for scale in SCALES {
        // A half circle of radius 1 above the z axis, its front towards the centre; the period is 3.
        let pieces = [arc([scale, 0.0], [-scale, 0.0], PI, 5)];
        let profile = Profile::new(pieces, 3.0 * scale).expect("sound");
        let mut r = ray([0.6 * scale, 0.0], [0.0, 1.0]);
        let h = hit(profile.meet(&mut r));
        assert_eq!(h.surface, 5);
        assert!((h.distance - 0.8 * scale).abs() < 1e-15 * scale, "{h:?}");
        assert!((h.normal - Vec3::new(0.0, -0.8, -0.6)).length() < 1e-14);
        // Mirrored between the walls: the same circle again, elsewhere.
        r.direction = Vec3::new(0.0, 0.0, -1.0);
        let h = hit(profile.meet(&mut r));
        assert!((h.distance - 1.2 * scale).abs() < 2e-15 * scale, "{h:?}");
        assert!((r.origin.z + 0.6 * scale).abs() < 1e-14 * scale && (r.origin.y - 0.8 * scale).abs() < 1e-14 * scale);
        // Outwards: the next period's arc lies behind its own opening.
        r.direction = Vec3::new(0.0, 1.0, 0.0);
        let h = hit(profile.meet(&mut r));
        assert!((h.distance - 3.0 * scale).abs() < 1e-14 * scale, "{h:?}");
    }
}

#[test]
fn a_convex_arc_is_not_met_by_rays_that_leave_it() {
    let mut numbers = Numbers(4, 0);
    for scale in SCALES {
        let profile = Profile::new([arc([-scale, 0.0], [scale, 0.0], -1.4, 0)], 10.0 * scale).expect("sound");
        for _ in 0..2000 {
            let mut r = ray([numbers.between(-0.9, 0.9) * scale, scale], [0.0, -1.0]);
            let h = hit(profile.meet(&mut r));
            // Along the surface but for a little.
            let along = Vec3::new(0.0, -h.normal.z, h.normal.y);
            r.direction = (along * if numbers.next() < 0.5 { 1.0 } else { -1.0 } + h.normal * 1e-7).unit();
            if let Meeting::Hit(again) = profile.meet(&mut r) {
                assert!(again.distance > scale, "{again:?}");
            }
        }
    }
}

/// Random sections of slats with arcs, prisms and posts that do not touch.
fn section(numbers: &mut Numbers) -> Option<(Vec<Piece>, f64)> {
    let scale = SCALES[(numbers.next() * 3.0) as usize];
    let period = scale * numbers.between(0.4, 2.0);
    let count = 1 + (numbers.next() * 5.0) as usize;
    let mut pieces: Vec<Piece> = Vec::new();
    for k in 0..count {
        let mut point = || [numbers.between(-1.0, 1.0) * scale, numbers.between(-0.3, 1.3) * period];
        let from = pieces.last().filter(|_| k % 3 != 0).map_or_else(&mut point, |p| p.to);
        let to = point();
        let turn = if numbers.next() < 0.5 {
            0.0
        } else {
            numbers.between(-4.0, 4.0)
        };
        pieces.push(arc(from, to, turn, k as u32));
    }
    Profile::new(&pieces, period).is_ok().then_some((pieces, period))
}

#[test]
fn random_sections_are_met_as_in_the_textbook() {
    let mut numbers = Numbers(8, 0);
    let (mut sections, mut hits, mut apart) = (0, 0, 0);
    while sections < 300 {
        let Some((pieces, period)) = section(&mut numbers) else {
            continue;
        };
        sections += 1;
        let profile = Profile::new(&pieces, period).expect("sound");
        let [low, high] = profile.depth();
        for _ in 0..30 {
            let mut r = Ray {
                origin: Vec3::new(0.0, numbers.between(0.0, period), numbers.between(low, high)),
                direction: numbers.direction(),
                piece: NO_PIECE,
            };
            if r.direction.z.abs() < 0.1 {
                continue;
            }
            let mut leaving = None;
            for _ in 0..4 {
                let expected = slow(&pieces, period, &r, leaving);
                let start = r;
                match (profile.meet(&mut r), expected) {
                    (Meeting::Hit(h), Some((t, k))) => {
                        hits += 1;
                        let surface = h.surface as usize;
                        // Tangents and ends are told apart by rounding.
                        if surface != k || (h.distance - t).abs() > 1e-9 * (t + period) {
                            apart += 1;
                            break;
                        }
                        let p = &pieces[k];
                        let [e, w] = [
                            [p.to[0] - p.from[0], p.to[1] - p.from[1]],
                            [r.origin.z - p.from[0], r.origin.y - p.from[1]],
                        ];
                        let y = (start.origin.y + start.direction.y * t - r.origin.y) / period;
                        assert!((y - y.round()).abs() < 1e-9, "{y}");
                        if p.turn == 0.0 {
                            assert!(
                                (e[0] * w[1] - e[1] * w[0]).abs()
                                    < 1e-14 * e[0].hypot(e[1]) * profile.depth[1].max(period)
                            );
                        }
                        assert!((h.normal.length() - 1.0).abs() < 1e-9);
                        leaving = Some(k);
                        // Scattered anywhere.
                        r.direction = numbers.direction();
                        if r.direction.z.abs() < 0.1 {
                            break;
                        }
                    }
                    (Meeting::Leaves, None) => break,
                    _ => {
                        apart += 1;
                        break;
                    }
                }
            }
        }
    }
    assert!(hits > 7000 && apart <= 1, "{hits} {apart}");
}

/// A film of random teeth, some of them round, on a flat sheet.
fn film(numbers: &mut Numbers, count: u32, scale: f64) -> Vec<Piece> {
    let heights: Vec<f64> = (0..count).map(|_| numbers.between(0.1, 3.0) * scale).collect();
    let at = |k: u32| [heights[(k % count) as usize], f64::from(k) * scale];
    let mut pieces = vec![segment([-scale, 0.0], [-scale, f64::from(count) * scale], 0)];
    for k in 0..count {
        let turn = if k % 3 == 0 { numbers.between(-0.3, 0.3) } else { 0.0 };
        pieces.push(arc(at(k + 1), at(k), turn, k + 1));
    }
    pieces
}

#[test]
fn many_pieces_are_met_like_few() {
    let mut numbers = Numbers(9, 0);
    let mut hits = 0;
    for (count, scale) in [(12, 1e-6), (40, 50e-6), (301, 0.1)] {
        let pieces = film(&mut numbers, count, scale);
        let period = f64::from(count) * scale;
        let profile = Profile::new(&pieces, period).expect("sound");
        assert!(profile.tree.is_some());
        profile.check_media(&vec![[0, 1]; pieces.len()]).expect("closed");
        // The same parts, every ray tried against every one.
        let mut slow = profile.clone();
        slow.tree = None;
        slow.targets = slow.parts.iter().map(|p| Target::new(p, period)).collect();
        for _ in 0..3000 {
            let mut a = Ray {
                origin: Vec3::new(
                    0.0,
                    numbers.between(-1.0, 2.0) * period,
                    numbers.between(-2.0, 4.0) * scale,
                ),
                direction: numbers.direction(),
                piece: NO_PIECE,
            };
            let mut b = a;
            for _ in 0..4 {
                match (profile.meet(&mut a), slow.meet(&mut b)) {
                    (Meeting::Hit(x), Meeting::Hit(y)) => {
                        hits += 1;
                        assert_eq!(a.piece, b.piece);
                        assert!((x.distance - y.distance).abs() < 1e-11 * (y.distance + scale));
                        assert!((x.normal - y.normal).length() < 1e-9);
                        b.origin = a.origin;
                        a.direction = numbers.direction();
                        b.direction = a.direction;
                    }
                    (x, y) => {
                        assert_eq!(x, y);
                        break;
                    }
                }
            }
        }
        assert_eq!(lost(&profile, 30_000, 1.5), 0);
    }
    assert!(hits > 15_000, "{hits}");
}

#[test]
fn batches_are_met_like_single_rays() {
    let mut numbers = Numbers(5, 0);
    let mut pieces = slat(0.08, 1.0, 0.3);
    pieces.push(segment([0.05, 0.0], [0.05, 0.03], 1));
    let profile = Profile::new(pieces, 0.072).expect("sound");
    let mut rays: Vec<Ray> = (0..1001)
        .map(|_| Ray {
            origin: Vec3::new(0.0, numbers.next(), numbers.between(-0.1, 0.1)),
            direction: numbers.direction(),
            piece: NO_PIECE,
        })
        .collect();
    for _ in 0..3 {
        let mut single = rays.clone();
        let expected: Vec<Meeting> = single.iter_mut().map(|r| profile.meet(r)).collect();
        let mut meetings = vec![Meeting::Lost; rays.len()];
        profile.meet_all(&mut rays, &mut meetings);
        assert_eq!((&meetings, &rays), (&expected, &single));
        assert!(meetings.iter().filter(|m| matches!(m, Meeting::Hit(_))).count() > 100);
        for ray in &mut rays {
            ray.direction = numbers.direction();
        }
    }
}

#[test]
fn flat_mirrors_pass_what_their_gaps_leave() {
    // Level mirror slats as wide as two periods: all light passes or returns, by the count of mirrorings.
    let (width, period, angle) = (2.0, 1.0, 0.9_f64);
    let profile = Profile::new(slat(width, 0.0, 0.0), period).expect("sound");
    let n = 10_000;
    let mut passed = 0;
    let mut downwards = 0;
    for k in 0..n {
        let y = (f64::from(k) + 0.5) / f64::from(n) * period;
        let mut r = ray([-1.5, y], [angle.cos(), angle.sin()]);
        while let Meeting::Hit(h) = profile.meet(&mut r) {
            r.direction = crate::material::mirrored(r.direction, h.normal);
        }
        passed += i32::from(r.direction.z > 0.0);
        downwards += i32::from(r.direction.y < 0.0);
    }
    assert_eq!(passed, n);
    // tan 0.9 · 2 = 2.520: 2 mirrorings for 48.0 %, 3 for the rest.
    let share = f64::from(downwards) / f64::from(n);
    assert!((share - (2.0 * angle.tan() - 2.0)).abs() <= 1e-4, "{share}");
}

/// Follows refracted light through a body, whose front is outwards, and counts paths that find the wrong side of it.
fn lost(profile: &Profile, n: u32, index: f64) -> u32 {
    let mut numbers = Numbers(6, 0);
    let mut lost = 0;
    let start = profile.depth()[0] - 0.1 * profile.period;
    for _ in 0..n {
        let direction = numbers.direction();
        let mut r = Ray {
            origin: Vec3::new(0.0, numbers.between(0.0, profile.period), start),
            direction: Vec3::new(direction.x, direction.y, direction.z.abs().max(1e-9)),
            piece: NO_PIECE,
        };
        let mut inside = false;
        for _ in 0..40 {
            let Meeting::Hit(h) = profile.meet(&mut r) else {
                lost += u32::from(inside);
                break;
            };
            let from_back = r.direction.dot(h.normal) > 0.0;
            if from_back != inside {
                lost += 1;
                break;
            }
            let normal = if from_back { -h.normal } else { h.normal };
            let ratio = if inside { index } else { 1.0 / index };
            let cos = -r.direction.dot(normal);
            let sin2 = ratio * ratio * (1.0 - cos * cos);
            if sin2 < 1.0 && numbers.next() < 0.8 {
                r.direction = (r.direction * ratio + normal * (ratio * cos - (1.0 - sin2).sqrt())).unit();
                inside = !inside;
            } else {
                r.direction = crate::material::mirrored(r.direction, normal);
            }
        }
    }
    lost
}

#[test]
fn closed_bodies_lose_nothing() {
    for scale in SCALES {
        // 45° prisms on a sheet, a pane, and round bars.
        let prism = [
            segment([0.0, 0.0], [0.0, scale], 0),
            segment([0.7 * scale, scale], [1.2 * scale, 0.5 * scale], 0),
            segment([1.2 * scale, 0.5 * scale], [0.7 * scale, 0.0], 0),
        ];
        let pane = [
            segment([0.0, 0.0], [0.0, scale], 0),
            segment([0.3 * scale, scale], [0.3 * scale, 0.0], 0),
        ];
        let bar = [
            arc([0.3 * scale, 0.5 * scale], [-0.3 * scale, 0.5 * scale], -PI, 0),
            arc([-0.3 * scale, 0.5 * scale], [0.3 * scale, 0.5 * scale], -PI, 0),
        ];
        let lens = [
            segment([0.0, 0.0], [0.0, scale], 0),
            arc([0.1 * scale, scale], [0.1 * scale, 0.0], -FRAC_PI_2, 0),
        ];
        for (name, pieces) in [
            ("prism", &prism[..]),
            ("pane", &pane[..]),
            ("bar", &bar[..]),
            ("lens", &lens[..]),
        ] {
            let profile = Profile::new(pieces, scale).expect("sound");
            assert_eq!(lost(&profile, 90_000, 1.5), 0, "{name} {scale}");
        }
    }
}

#[test]
fn slats_a_quarter_turned_do_not_join() {
    // As wide as 0.999 of the period, upright: light passes through the gap and nowhere else.
    let profile = Profile::new(slat(0.999, 0.0, FRAC_PI_2), 1.0).expect("sound");
    let n = 100_000;
    let through = (0..n)
        .filter(|k| {
            let y = (f64::from(*k) + 0.5) / f64::from(n) * 7.0;
            profile.meet(&mut ray([-1.0, y], [FRAC_PI_4.cos(), FRAC_PI_4.sin()])) == Meeting::Leaves
        })
        .count();
    assert_eq!(through, n as usize / 1000);
}
