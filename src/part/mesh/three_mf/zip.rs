//! The archive of a 3MF file: names, and the bytes of the parts that are asked for.
//!
//! # Method
//! The directory at the end of a ZIP file lists its parts, with their sizes and where they begin (APPNOTE.TXT
//! of PKWARE, 4.3 and 4.5 for sizes beyond 32 bits). A part is stored, or packed with deflate; other ways of
//! packing and encryption are refused.
//!
//! # Guarantees
//! * A part is unpacked to at most `MOST_RATIO` times its packed size and `SLACK` bytes more, and all parts
//!   to at most as many bytes as the caller allows: a small file cannot fill the memory.
//! * The sum of a part is checked.

use flate2::{Crc, Decompress, FlushDecompress, Status};
use toolpathd_core::budget::Budget;

use crate::fault::{Place, Unreadable};
use crate::mesh::bytes::{Bytes, Order};

/// Most bytes that a packed byte may become. XML of triangles is packed to a tenth, seldom to a fiftieth;
/// deflate reaches 1032.
const MOST_RATIO: usize = 200;

/// Bytes that a part may have in any case, however well it is packed.
const SLACK: usize = 1 << 20;

/// Bytes that are unpacked between two looks at the budget.
const STEP: usize = 1 << 20;

/// Most parts of an archive.
const MOST_PARTS: usize = 10_000;

/// The signatures of the records, and the lengths of their fixed parts.
const END: (&[u8], usize) = (b"PK\x05\x06", 22);
const END_64: (&[u8], usize) = (b"PK\x06\x06", 56);
const LOCATOR_64: (&[u8], usize) = (b"PK\x06\x07", 20);
const ENTRY: (&[u8], usize) = (b"PK\x01\x02", 46);
const LOCAL: (&[u8], usize) = (b"PK\x03\x04", 30);

/// Most bytes of the remark at the end of an archive.
const LONGEST_REMARK: usize = 65_535;

/// An archive.
pub struct Archive<'a> {
    bytes: &'a [u8],
    parts: Vec<Part>,
    /// How many bytes may still be unpacked.
    n_allowed: usize,
}

/// A part of an archive, as the directory lists it.
struct Part {
    name: String,
    is_encrypted: bool,
    method: u16,
    sum: u32,
    packed: u64,
    unpacked: u64,
    local: u64,
    place: Place,
}

impl<'a> Archive<'a> {
    /// Reads the directory. All parts together may be unpacked to `most_bytes`.
    ///
    /// # Errors
    /// When the file is no whole archive.
    pub fn of(bytes: &'a [u8], most_bytes: usize) -> Result<Self, Unreadable> {
        let (n_parts, start) = directory(bytes)?;
        if n_parts > MOST_PARTS as u64 {
            let detail = format!("the archive has {n_parts} parts; at most {MOST_PARTS} are read");
            return Err(Unreadable::at(Place::File, detail));
        }
        let mut entries = at(bytes, start)?;
        let parts = (0..n_parts).map(|_| entry(&mut entries)).collect::<Result<_, _>>()?;
        Ok(Self { bytes, parts, n_allowed: most_bytes })
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.parts.iter().map(|part| part.name.as_str())
    }

    /// The text of a part. Upper and lower case are the same in names, and a slash before a name counts for
    /// nothing.
    ///
    /// # Errors
    /// When there is no such part, when it is broken or too large, or when it is no UTF-8.
    pub fn text(&mut self, name: &str, budget: &Budget) -> Result<String, Unreadable> {
        let name = name.trim_start_matches('/');
        let is = |part: &&Part| part.name.trim_start_matches('/').eq_ignore_ascii_case(name);
        let Some(part) = self.parts.iter().find(is) else {
            return Err(Unreadable::at(Place::File, format!("the archive has no part {name}")));
        };
        let unpacked = unpack(self.bytes, part, self.n_allowed, budget)?;
        self.n_allowed -= unpacked.len();
        let fault = |_| Unreadable::at(part.place, format!("{name} is not written in UTF-8"));
        String::from_utf8(unpacked).map_err(fault)
    }
}

/// The number of parts, and where their list begins.
fn directory(bytes: &[u8]) -> Result<(u64, u64), Unreadable> {
    let from = bytes.len().saturating_sub(END.1 + LONGEST_REMARK);
    let found = bytes[from..].windows(END.1).rposition(|window| window.starts_with(END.0));
    let found = found.ok_or_else(|| Unreadable::at(Place::File, "the end of the ZIP archive is missing"))?;
    let end = from + found;
    let mut record = at(bytes, end as u64 + 10)?;
    let (n_parts, _size, start) = (record.u16()?, record.u32()?, record.u32()?);
    let locator = end.checked_sub(LOCATOR_64.1).filter(|at| bytes[*at..].starts_with(LOCATOR_64.0));
    let Some(locator) = locator else { return Ok((n_parts.into(), start.into())) };
    let end_64 = at(bytes, locator as u64 + 8)?.u64()?;
    let mut record = signed(bytes, end_64, END_64)?;
    record.take(32 - END_64.0.len())?;
    let (n_parts, _size, start) = (record.u64()?, record.u64()?, record.u64()?);
    Ok((n_parts, start))
}

/// The bytes of a file from `start` on.
fn at(bytes: &[u8], start: u64) -> Result<Bytes<'_>, Unreadable> {
    match usize::try_from(start) {
        Ok(start) if start <= bytes.len() => Ok(Bytes::new(bytes, start, Order::LittleEndian)),
        _ => Err(Unreadable::at(Place::File, format!("the archive points to byte {start}, behind its end"))),
    }
}

/// The bytes behind the signature of a record.
fn signed<'a>(bytes: &'a [u8], start: u64, (signature, _): (&[u8], usize)) -> Result<Bytes<'a>, Unreadable> {
    let mut record = at(bytes, start)?;
    check_signature(&mut record, signature)?;
    Ok(record)
}

fn check_signature(record: &mut Bytes, signature: &[u8]) -> Result<(), Unreadable> {
    let place = record.place();
    if record.take(signature.len())? == signature {
        return Ok(());
    }
    Err(Unreadable::at(place, "the archive is damaged: no record begins here"))
}

/// The next entry of the directory.
fn entry(entries: &mut Bytes) -> Result<Part, Unreadable> {
    let place = entries.place();
    check_signature(entries, ENTRY.0)?;
    entries.take(4)?;
    let (flags, method) = (entries.u16()?, entries.u16()?);
    entries.take(4)?;
    let (sum, packed, unpacked) = (entries.u32()?, entries.u32()?, entries.u32()?);
    let lengths = [entries.u16()?, entries.u16()?, entries.u16()?].map(usize::from);
    entries.take(8)?;
    let local = entries.u32()?;
    let name = String::from_utf8_lossy(entries.take(lengths[0])?).into_owned();
    let extra = entries.take(lengths[1])?;
    entries.take(lengths[2])?;
    let mut sizes = [unpacked, packed, local].map(u64::from);
    widen(&mut sizes, extra)?;
    let [unpacked, packed, local] = sizes;
    Ok(Part { name, is_encrypted: flags & 1 != 0, method, sum, packed, unpacked, local, place })
}

/// Takes sizes beyond 32 bits from the extra field 1, which has those that are all ones in the entry.
fn widen(sizes: &mut [u64; 3], extra: &[u8]) -> Result<(), Unreadable> {
    let mut fields = Bytes::new(extra, 0, Order::LittleEndian);
    while fields.n_left() >= 4 {
        let (kind, length) = (fields.u16()?, fields.u16()?.into());
        if length > fields.n_left() {
            break;
        }
        let mut field = Bytes::new(fields.take(length)?, 0, Order::LittleEndian);
        if kind == 1 {
            for size in sizes.iter_mut().filter(|size| **size == u64::from(u32::MAX)) {
                *size = field.u64()?;
            }
        }
    }
    Ok(())
}

fn unpack(bytes: &[u8], part: &Part, n_allowed: usize, budget: &Budget) -> Result<Vec<u8>, Unreadable> {
    let fault = |detail: String| Unreadable::at(part.place, format!("{} {detail}", part.name));
    if part.is_encrypted {
        return Err(fault("is encrypted".into()));
    }
    let mut local = signed(bytes, part.local, LOCAL)?;
    local.take(LOCAL.1 - LOCAL.0.len() - 4)?;
    let before = usize::from(local.u16()?) + usize::from(local.u16()?);
    local.take(before)?;
    let packed = usize::try_from(part.packed).ok().filter(|packed| *packed <= local.n_left());
    let Some(packed) = packed else { return Err(fault("is longer than the file".into())) };
    let packed = local.take(packed)?;
    let most = n_allowed.min(packed.len().saturating_mul(MOST_RATIO).saturating_add(SLACK));
    if part.unpacked > most as u64 {
        return Err(fault(format!("has {} bytes when unpacked; at most {most} are read", part.unpacked)));
    }
    let size = part.unpacked as usize;
    let unpacked = match part.method {
        0 => packed.to_vec(),
        8 => inflate(packed, size, budget)?.ok_or_else(|| fault("is damaged".into()))?,
        other => return Err(fault(format!("is packed by the method {other}; only deflate is read"))),
    };
    if unpacked.len() != size {
        return Err(fault("has another length than the archive states".into()));
    }
    let mut sum = Crc::new();
    sum.update(&unpacked);
    if sum.sum() != part.sum {
        return Err(fault("is damaged: its sum differs from the one that the archive states".into()));
    }
    Ok(unpacked)
}

/// Unpacks at most `size` bytes; `None` where they are damaged, or more follow.
fn inflate(packed: &[u8], size: usize, budget: &Budget) -> Result<Option<Vec<u8>>, Unreadable> {
    let mut inflate = Decompress::new(false);
    let mut unpacked = Vec::new();
    loop {
        budget.check()?;
        let before = (inflate.total_in(), inflate.total_out());
        // One byte more than stated shows that the statement is wrong.
        unpacked.reserve(STEP.min(size + 1 - unpacked.len()));
        let rest = &packed[before.0 as usize..];
        match inflate.decompress_vec(rest, &mut unpacked, FlushDecompress::None) {
            Ok(Status::StreamEnd) => return Ok(Some(unpacked)),
            Ok(_) if (inflate.total_in(), inflate.total_out()) != before && unpacked.len() <= size => {}
            _ => return Ok(None),
        }
    }
}
