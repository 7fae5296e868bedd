//! Damaged files: each is read or refused, without a panic and without much memory.

use proptest::prelude::*;

use super::solids::Triangles;
use super::writing::all;
use super::*;

const FORMATS: [MeshFormat; 4] = [MeshFormat::Stl, MeshFormat::Obj, MeshFormat::Ply, MeshFormat::ThreeMf];

/// Reads a file that may be damaged, and takes its figures.
fn try_read(format: MeshFormat, bytes: &[u8]) -> Option<MeshFile> {
    let mesh = read(format, bytes, 1000, &Budget::unlimited()).ok()?;
    figures_of(&mesh);
    Some(mesh)
}

#[test]
fn a_file_that_is_cut_off_is_refused_or_lacks_triangles() {
    for (name, format, bytes) in all(&Triangles::cuboid([0.0; 3], [1.0; 3])) {
        let whole = read_whole(format, &bytes);
        for end in 0..bytes.len() {
            let Some(mesh) = try_read(format, &bytes[..end]) else { continue };
            match format {
                // A text of vertices and faces states no number of them.
                MeshFormat::Obj => assert!(mesh.triangles.len() <= whole.triangles.len(), "{name} {end}"),
                // The name behind `endsolid` and the last end of line may lack.
                MeshFormat::Stl => assert!(end + 8 >= bytes.len() && mesh == whole, "{name} {end}"),
                MeshFormat::Ply => assert!(end + 1 == bytes.len() && mesh == whole, "{name} {end}"),
                MeshFormat::ThreeMf => panic!("{name} {end}"),
            }
        }
    }
}

#[test]
fn a_changed_byte_does_no_harm() {
    for (_, format, bytes) in all(&Triangles::tetrahedron([1.0, 2.0, 3.0])) {
        for at in 0..bytes.len() {
            for change in [1, 2, 16, 128, 255] {
                let mut broken = bytes.clone();
                broken[at] ^= change;
                try_read(format, &broken);
            }
        }
    }
}

proptest! {
    #[test]
    fn noise_does_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..300), text in "[-+0-9a-z./\\\\ \n#]{0,300}") {
        for format in FORMATS {
            try_read(format, &bytes);
            try_read(format, text.as_bytes());
        }
    }

    /// Two pieces of a file change places.
    #[test]
    fn shuffled_pieces_do_no_harm(at in prop::collection::vec(0.0..1.0_f64, 3)) {
        for (_, format, bytes) in all(&Triangles::tetrahedron([1.0, 2.0, 3.0])) {
            let mut at: Vec<usize> = at.iter().map(|at| (at * bytes.len() as f64) as usize).collect();
            at.sort_unstable();
            let [a, b, c] = [at[0], at[1], at[2]];
            try_read(format, &[&bytes[..a], &bytes[b..c], &bytes[a..b], &bytes[c..]].concat());
        }
    }
}
