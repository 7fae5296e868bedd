//! Wavefront OBJ: vertices, and faces that name them by their numbers.
//!
//! # Method
//! The text is read twice: for the vertices, and then for the faces, which may name vertices that follow. All
//! groups and objects of a file become one mesh. A line that ends with a backslash goes on in the next line.

use std::borrow::Cow;

use toolpathd_core::budget::Budget;

use super::STEPS_PER_CHECK;
use super::polygon;
use super::welding::Welding;
use super::words::{number, shown};
use crate::fault::{Place, Unreadable};

pub fn read(bytes: &[u8], welding: &mut Welding, budget: &Budget) -> Result<(), Unreadable> {
    let mut vertices = Vec::new();
    for (k, Statement { keyword, values, place }) in statements(bytes).enumerate() {
        if k.is_multiple_of(STEPS_PER_CHECK) {
            budget.check()?;
        }
        if keyword == b"v" {
            let point = point(&values, place, welding)?;
            vertices.push(welding.vertex(point, place)?);
        }
    }
    let mut n_before = 0;
    let mut corners = Vec::new();
    for (k, Statement { keyword, values, place }) in statements(bytes).enumerate() {
        if k.is_multiple_of(STEPS_PER_CHECK) {
            budget.check()?;
        }
        match keyword {
            b"v" => n_before += 1,
            // `fo` is an old name of faces.
            b"f" | b"fo" => {
                corners.clear();
                for value in words(&values) {
                    corners.push(corner(value, n_before, &vertices, place)?);
                }
                polygon::add(&corners, place, welding, budget)?;
            }
            _ => leave_out(keyword, place, welding),
        }
    }
    Ok(())
}

/// A line, or several lines of which all but the last end with a backslash.
struct Statement<'a> {
    keyword: &'a [u8],
    values: Cow<'a, [u8]>,
    place: Place,
}

/// The statements of a text, without comments.
fn statements(bytes: &[u8]) -> impl Iterator<Item = Statement<'_>> {
    let mut lines = lines(bytes);
    std::iter::from_fn(move || {
        loop {
            let (number, first) = lines.next()?;
            if first.starts_with(b"#") {
                continue;
            }
            let end = first.iter().position(|byte| byte.is_ascii_whitespace() || *byte == b'\\');
            let (keyword, values) = first.split_at(end.unwrap_or(first.len()));
            let mut values = Cow::Borrowed(without_comment(values));
            while values.ends_with(b"\\") {
                let whole = values.to_mut();
                whole.pop();
                whole.push(b' ');
                whole.extend(lines.next().map_or(&b""[..], |(_, next)| without_comment(next)));
            }
            if !keyword.is_empty() {
                return Some(Statement { keyword, values, place: Place::Line(number) });
            }
        }
    })
}

fn without_comment(line: &[u8]) -> &[u8] {
    line.iter().position(|byte| *byte == b'#').map_or(line, |end| &line[..end])
}

/// The lines of a text with their numbers from 1 on, without blanks around them. Lines end with LF, CR LF or
/// CR.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (u64, &[u8])> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let has_lf = bytes.contains(&b'\n');
    let end = if has_lf { b'\n' } else { b'\r' };
    (1..).zip(bytes.split(move |byte| *byte == end).map(<[u8]>::trim_ascii))
}

fn words(values: &[u8]) -> impl Iterator<Item = &[u8]> {
    values.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// The point of a statement `v x y z [w] [red green blue]`.
fn point(values: &[u8], place: Place, welding: &mut Welding) -> Result<[f64; 3], Unreadable> {
    let mut point = [0.0; 3];
    let mut words = words(values);
    for value in &mut point {
        let word = words.next().ok_or_else(|| Unreadable::at(place, "a vertex has three coordinates"))?;
        *value =
            number(word).ok_or_else(|| Unreadable::at(place, format!("{} is no coordinate", shown(word))))?;
    }
    match words.count() {
        0 => {}
        1 => welding.left_out.add("v", "weights of vertices are not read", place),
        _ => welding.left_out.add("v", "colours of vertices are not read", place),
    }
    Ok(point)
}

/// The vertex that `7`, `7/1`, `7//3` or `-2/1/3` names: counted from 1, or backwards from the last before.
fn corner(word: &[u8], n_before: usize, vertices: &[u32], place: Place) -> Result<u32, Unreadable> {
    let digits = word.split(|byte| *byte == b'/').next().unwrap_or_default();
    let number = std::str::from_utf8(digits).ok().and_then(|digits| digits.parse::<i64>().ok());
    let number =
        number.ok_or_else(|| Unreadable::at(place, format!("{} is no number of a vertex", shown(word))))?;
    let index = if number < 0 { n_before as i64 + number } else { number - 1 };
    let found = usize::try_from(index).ok().and_then(|index| vertices.get(index).copied());
    found.ok_or_else(|| {
        Unreadable::at(place, format!("there is no vertex {number}; the file has {}", vertices.len()))
    })
}

/// Counts a statement that is neither a vertex nor a face.
fn leave_out(keyword: &[u8], place: Place, welding: &mut Welding) {
    let reason = match keyword {
        b"vn" => "the order of the corners tells where outside is",
        b"vt" => "textures are not read",
        b"g" | b"o" | b"s" | b"mg" => "all groups become one mesh",
        b"usemtl" | b"mtllib" | b"usemap" | b"maplib" => "materials are not read",
        b"l" | b"p" => "lines and points have no area",
        b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm" | b"trim"
        | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"bzp" | b"bsp" | b"cdc" | b"cdp" | b"res" => {
            "free-form curves and surfaces are not read"
        }
        b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj" | b"ctech"
        | b"stech" => "it tells how the file is drawn",
        b"call" | b"csh" => "other files and commands are not read",
        _ => return welding.left_out.add("statement", "OBJ has no statement of its name", place),
    };
    welding.left_out.add(&String::from_utf8_lossy(keyword), reason, place);
}
