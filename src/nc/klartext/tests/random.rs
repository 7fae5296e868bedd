//! Random bytes and mutations of good programs: whatever the text, the reader ends without a panic.

use super::programs::ALL;
use super::*;
use crate::machine::{Correction, Cutter};

/// Numbers from a seed (Knuth's MMIX).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound.max(1)
    }
}

fn reads(text: &[u8]) {
    let control = Control::named("heidenhain").unwrap();
    let three = [Cutter { number: None, radius_mm: 3.0 }];
    for correction in [Correction::Refused, Correction::Computed(&three)] {
        let job = ReadJob { most_moves: 1000, correction, ..ReadJob::plain(text, control) };
        if let Err(ReadError::Refused(refusals)) = read(&job, &Budget::unlimited()) {
            assert!(!refusals.is_empty());
            for refusal in refusals {
                assert!(refusal.column > 0 && refusal.line > 0 && !refusal.to_string().is_empty());
            }
        }
    }
}

const PIECES: [&str; 70] = [
    "L ",
    "X+10",
    "IX-5",
    "Y",
    "Z-1,5",
    "FMAX",
    "F100",
    "R0",
    "RL",
    "M99",
    "M91",
    "CC ",
    "C ",
    "CR ",
    "CT ",
    "CP ",
    "LP ",
    "CTP ",
    "RND R5",
    "CHF 2",
    "DR+",
    "DR-",
    "PR+5",
    "IPA+720",
    "PA-90",
    "\n",
    "\n",
    "\n",
    "~\n",
    ";",
    "\"",
    "Q1 = ",
    "Q1",
    "QL5",
    "(",
    ")",
    "+",
    "-",
    "^",
    "SIN ",
    "FN 1: Q2 = +1 + +Q1",
    "FN 9: IF +Q1 EQU +0 GOTO LBL 1",
    "LBL 1",
    "LBL 0",
    "CALL LBL 1",
    " REP 3",
    "CALL PGM A",
    "CYCL DEF 7.0\nCYCL DEF 7.1 X+5",
    "CYCL DEF 10.0\nCYCL DEF 10.1 IROT+33",
    "CYCL DEF 8.0\nCYCL DEF 8.1 X",
    "CYCL CALL",
    "CYCL CALL PAT FMAX",
    "CYCL CALL POS X1 Y1 Z1 FMAX",
    "PATTERN DEF POS1 (X+1 Y+2 Z+0)",
    "CYCL DEF 200 Q200=2 Q201=-9 Q206=9 Q202=3 Q203=0 Q204=5",
    "CYCL DEF 203 Q200=2 Q201=-9 Q206=9 Q202=3 Q203=0 Q204=5 Q208=0 Q213=1 Q256=1 Q212=1 Q205=1",
    "CYCL DEF 209 Q200=2 Q201=-9 Q239=1 Q203=0 Q204=5 Q257=2 Q256=0",
    "APPR LT X+10 Y+20 LEN5 RL F100\n",
    "APPR CT X+10 Y+20 CCA90 R-5 RR F100\n",
    "APPR LCT X+10 Y+20 R5 RL F100\n",
    "DEP LN LEN5\n",
    "DEP LCT X+0 Y+0 R5\n",
    "TOOL DEF 1 L+0 R+3",
    "PLANE SPATIAL SPA+0 SPB+0 SPC+0 STAY",
    "A+Q120",
    "TOOL CALL 2 Y S100",
    "CYCL DEF 247 Q339=2",
    "1e9",
    "99999999999",
    "END PGM A MM\nBEGIN PGM B INCH\n",
];

#[test]
fn random_pieces_do_no_harm() {
    let mut numbers = Numbers(1);
    for _ in 0..8000 {
        let mut text = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F100\nL X+0 Y+0 Z+5 FMAX\n".to_owned();
        for _ in 0..numbers.below(40) {
            text.push_str(PIECES[numbers.below(PIECES.len())]);
            if numbers.below(3) == 0 {
                text.push('\n');
            }
        }
        text.push_str("\nEND PGM A MM\n");
        reads(text.as_bytes());
    }
}

#[test]
fn random_bytes_do_no_harm() {
    let mut numbers = Numbers(2);
    for _ in 0..5000 {
        let text: Vec<u8> = (0..numbers.below(120)).map(|_| numbers.below(256) as u8).collect();
        reads(&text);
        let mut framed = b"BEGIN PGM A MM\n".to_vec();
        framed.extend(text);
        reads(&framed);
    }
}

#[test]
fn mutated_programs_do_no_harm() {
    let mut numbers = Numbers(3);
    for _ in 0..8000 {
        let mut text = ALL[numbers.below(ALL.len())].as_bytes().to_vec();
        for _ in 0..=numbers.below(4) {
            let at = numbers.below(text.len());
            match numbers.below(5) {
                0 => drop(text.remove(at)),
                1 => text.insert(at, b" \n~;/\"+-.0123456789QLXYZIRF="[numbers.below(28)]),
                2 => text[at] = numbers.below(256) as u8,
                3 => {
                    let end = (at + numbers.below(30)).min(text.len());
                    drop(text.drain(at..end));
                }
                _ => {
                    let other = ALL[numbers.below(ALL.len())].as_bytes();
                    let from = numbers.below(other.len());
                    let piece = other[from..(from + 40).min(other.len())].to_vec();
                    drop(text.splice(at..at, piece));
                }
            }
            if text.is_empty() {
                text.push(b'L');
            }
        }
        reads(&text);
    }
}

#[test]
fn long_names_numbers_and_blocks_do_no_harm() {
    for text in [
        framed(&format!("L X+{}", "9".repeat(5000))),
        framed(&format!("LBL \"{}\"", "x".repeat(5000))),
        framed(&format!("TOOL CALL \"{}\" Z", "x".repeat(5000))),
        framed(&"L X+1 ~\n".repeat(5000)),
        framed(&"CYCL DEF 200 ~\n".repeat(5000)),
        framed(&format!("TOOL CALL {} Z", "9".repeat(30))),
        framed("L X+1e5\nL X+1e400\nL X+99999999999999999999 F100"),
        framed("CC X+0 Y+0\nLP PR+1 PA+0\nCP IPA+99999 IZ+1 DR+"),
        framed("L X+5 M99999999999"),
        framed(&format!("L {}", "X1".repeat(1_000_000))),
        framed(&format!("L {}", "M3".repeat(1_000_000))),
        framed(&format!("TOOL CALL {}", "S3".repeat(1_000_000))),
        framed(&format!("Q1 = {}1", "1+".repeat(1_000_000))),
        framed(&format!("CYCL DEF 200 {}", "Q200=1 ".repeat(300_000))),
        framed(&format!("PATTERN DEF {}", "POS1(X1Y1)".repeat(300_000))),
        framed(&format!("CYCL DEF 26.0\nCYCL DEF 26.1 {}", "X2".repeat(1_000_000))),
        framed(&"L".repeat(2_000_000)),
        "BEGIN PGM A MM\nLBL 1\nEND PGM A MM\n".repeat(30_000),
        "~".to_owned(),
        "\"".to_owned(),
        "BEGIN PGM".to_owned(),
        "BEGIN PGM A MM\n\"\nEND PGM".to_owned(),
    ] {
        reads(text.as_bytes());
    }
}
