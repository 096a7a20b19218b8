//! Normals of faces that have none, in files that say which faces are smooth (`s 1`).

use std::collections::HashMap;

use glam::Vec3;

/// Numbers of a corner: position, texture coordinates, normal.
pub(super) type Corner = (u32, Option<u32>, Option<u32>);

/// Numbers of normals that are made, apart from those of the file.
const MADE: u32 = 1 << 31;

/// Smoothing groups, and normals as they ask for.
#[derive(Default)]
pub(super) struct Smoothing {
    /// Whether any face is smooth; without, the importer makes the normals.
    is_used: bool,
    /// The group that holds; 0: faces are flat.
    group: u32,
    number_of: HashMap<(u32, u32), u32>,
    /// Sums of the normals of faces, twice their area long.
    sums: Vec<Vec3>,
}

impl Smoothing {
    /// For a file with these lines.
    pub(super) fn of_file(bytes: &[u8]) -> Self {
        let is_smooth = |line: &[u8]| {
            let line = line.trim_ascii();
            let rest = line.strip_prefix(b"s").unwrap_or_default();
            let is_whole = rest.first().is_some_and(u8::is_ascii_whitespace);
            is_whole && group(&String::from_utf8_lossy(rest)) > 0
        };
        Self {
            is_used: bytes.split(|b| b"\r\n".contains(b)).any(is_smooth),
            ..Self::default()
        }
    }

    /// Faces belong to another group from here on.
    pub(super) fn set(&mut self, text: &str) {
        self.group = group(text);
    }

    /// Gives a face without normals the numbers of those that are made: one for each vertex and smoothing
    /// group, or where the face is flat one of its own.
    pub(super) fn add(&mut self, face: &mut [Corner], places: &[[f32; 3]]) {
        if !self.is_used || face.iter().any(|corner| corner.2.is_some()) {
            return;
        }
        let ends = places.iter().zip(places.iter().cycle().skip(1));
        let sum = ends.fold(Vec3::ZERO, |sum, (a, b)| {
            let from_first = |place: &[f32; 3]| Vec3::from(*place) - Vec3::from(places[0]);
            sum + from_first(a).cross(from_first(b))
        });
        let sum = if sum.is_finite() { sum } else { Vec3::ZERO };
        let own = self.sums.len() as u32;
        if self.group == 0 {
            self.sums.push(sum);
        }
        for (position, _, normal) in face {
            let number = match self.group {
                0 => own,
                group => {
                    let next = self.sums.len() as u32;
                    let number = *self.number_of.entry((group, *position)).or_insert(next);
                    if number == next {
                        self.sums.push(Vec3::ZERO);
                    }
                    self.sums[number as usize] += sum;
                    number
                }
            };
            *normal = Some(MADE | number);
        }
    }

    /// A normal of the file, or one that was made; zero where its faces have no area.
    pub(super) fn normal(&self, number: u32, of_file: &[[f32; 3]]) -> [f32; 3] {
        match number & MADE {
            0 => of_file[number as usize],
            _ => self.sums[(number & !MADE) as usize]
                .normalize_or_zero()
                .to_array(),
        }
    }
}

/// The number of a smoothing group.
fn group(text: &str) -> u32 {
    match text.split_ascii_whitespace().next() {
        Some("on") => 1,
        number => number.and_then(|n| n.parse().ok()).unwrap_or(0),
    }
}

#[cfg(test)]
mod tests {
    use crate::{LoadOptions, Scene, load_bytes};

    fn load(text: &str) -> Scene {
        let no_files = |_: &str| Err("no files".to_owned());
        load_bytes(text.as_bytes(), "a.obj", &LoadOptions::default(), &no_files).unwrap()
    }

    /// Normals at places, sorted.
    fn normals(scene: &Scene) -> Vec<([i32; 3], [i32; 3])> {
        let vertices = scene.meshes[0].vertices.iter();
        let whole = |v: [f32; 3]| v.map(|x| (x * 100.0).round() as i32);
        let mut found: Vec<_> = vertices
            .map(|v| (whole(v.position), whole(v.normal)))
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// A roof of two squares at a right angle, with these lines before each.
    fn roof(first: &str, second: &str) -> String {
        format!(
            "v 0 0 0\nv 1 0 0\nv 1 0 -1\nv 0 0 -1\nv 0 -1 0\nv 1 -1 0\n\
             {first}\nf 1 2 3 4\n{second}\nf 5 6 2 1\n"
        )
    }

    #[test]
    fn faces_of_a_smoothing_group_share_normals() {
        let at_the_edge = |text: &str| {
            let scene = load(text);
            assert_eq!(scene.warnings, []);
            let all = normals(&scene).into_iter();
            let edge = all.filter(|(place, _)| *place == [0, 0, 0]);
            edge.map(|(_, normal)| normal).collect::<Vec<_>>()
        };
        let (up, front, between) = ([0, 100, 0], [0, 0, 100], [0, 71, 71]);
        for (first, second) in [("s 1", ""), ("s\t7", "s 7 # round"), ("s on", "s 1")] {
            assert_eq!(at_the_edge(&roof(first, second)), [between], "{first}");
        }
        for (first, second) in [
            ("", ""),
            ("s 1", "s 2"),
            ("s 1", "s off"),
            ("", "s 1"),
            ("s 0", "s off"),
        ] {
            assert_eq!(at_the_edge(&roof(first, second)), [front, up], "{first}");
        }
    }

    #[test]
    fn normals_of_the_file_and_of_faces_without_area_stay_what_they_are() {
        let given = "vn 0 0.6 0.8\n".to_owned() + &roof("s 1", "");
        let scene = load(&given.replace("1 2 3 4", "1//1 2//1 3//1 4//1"));
        let all = normals(&scene);
        assert!(all.contains(&([100, 0, -100], [0, 60, 80])), "{all:?}");
        assert!(all.contains(&([0, 0, 0], [0, 0, 100])), "{all:?}");
        // It has no area: its vertices have no normal but others'.
        let scene = load(&(roof("s 1", "") + "f 1 2 1\n"));
        assert!(normals(&scene).contains(&([0, 0, 0], [0, 71, 71])));
        let nowhere = roof("s 1", "") + "v nan 0 0\nf 1 2 7\n";
        assert!(normals(&load(&nowhere)).contains(&([0, 0, 0], [0, 71, 71])));
    }
}
