//! Random texts and random changes of good programs: no input may panic or hang.

use std::sync::Arc;

use toolpathd_core::budget::ProgressSink;

use super::*;
use crate::siemens::tests::programs::PROGRAMS;

/// Cases of each test.
const N_CASES: usize = 10_000;

/// Numbers that look random, the same in each run (Knuth, *MMIX*, a linear congruential generator).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n
    }
}

fn must_end(text: &[u8], budget: &Budget) {
    let siemens = Control::named("siemens").unwrap();
    let job = ReadJob { most_moves: 2000, ..ReadJob::plain(text, siemens) };
    let _ = read(&job, budget);
}

/// Cancels its budget when the run has gone on for some thousand blocks.
struct Patience(Budget);

impl ProgressSink for Patience {
    fn progress(&self, _: &'static str, done: usize, _: usize) {
        if done > 0 {
            self.0.cancel();
        }
    }
}

/// Loops that run millions of blocks would take the whole time of a test.
fn short() -> Budget {
    let budget = Budget::unlimited();
    budget.clone().with_progress(Arc::new(Patience(budget)))
}

#[test]
fn random_bytes_and_words_do_not_panic() {
    let words = [
        "G0",
        "G1",
        "G2",
        "X10",
        "Y=R1",
        "Z-5",
        "I5",
        "CR=5",
        "AR=90",
        "RND=2",
        "RNDM=1",
        "CHF=1",
        "\n",
        "\n",
        "\n",
        "R1=5",
        "R[1]=R1+1",
        "IF R1==5",
        "ELSE",
        "ENDIF",
        "FOR R1=1 TO 3",
        "ENDFOR",
        "GOTOF AA",
        "AA:",
        "N10",
        "TRANS X1",
        "ROT RPL=30",
        "MIRROR X0",
        "SCALE X2",
        "G18",
        "G91",
        "G54",
        "G53",
        "AP=30",
        "RP=5",
        "G111 X1",
        "MCALL CYCLE83(9,0,1,-5,,,2,,,,,1)",
        "CYCLE81(9,0,1,-5)",
        "HOLES1(0,0,0,1,1,3)",
        "MCALL",
        "MCALL AA(1)",
        "CALL \"AA\"",
        "ANG=30",
        "X=IC(5)",
        "CYCLE801(0,0,0,1,1,3,2)",
        "CYCLE802(111111111,111111111,1,2,3,4)",
        "HOLES2(0,0,9,0,0,3,1000)",
        "M30",
        "T1 M6",
        "D1",
        "CIP I1=1 J1=1",
        "CT",
        "TURN=2",
        "G93",
        "F100",
        "S1000",
        "(",
        ")",
        "\"",
        ";",
        "=",
        "[",
        "]",
        "$P_UIFR[1]=",
        "CTRANS(X,1)",
        "DEF REAL AB[3]",
        "PROC AA(REAL BB=1)",
        "%_N_AA_SPF",
        "AA(1,2)",
        "REPEAT AA P=2",
        "REPEATB AA",
        "CASE R1 OF 1 GOTOF AA",
        "1EX999",
        "-",
        "G74 X1=0",
        "G4 F1",
        "L1",
        "SUPA",
        "REPEAT",
        "UNTIL R1>1",
        "WHILE",
        "MSG(",
    ];
    let mut numbers = Numbers(1);
    for case in 0..N_CASES {
        let mut text = Vec::new();
        for _ in 0..numbers.below(30) {
            if case % 3 == 0 {
                text.push(numbers.below(256) as u8);
            } else {
                text.extend_from_slice(words[numbers.below(words.len())].as_bytes());
                text.push(b' ');
            }
        }
        must_end(&text, &short());
    }
}

#[test]
fn changed_programs_do_not_panic() {
    let mut numbers = Numbers(2);
    for _ in 0..N_CASES {
        let (program, ..) = PROGRAMS[numbers.below(PROGRAMS.len())];
        let mut text = program.as_bytes().to_vec();
        for _ in 0..1 + numbers.below(6) {
            let at = numbers.below(text.len());
            match numbers.below(4) {
                0 => text[at] = b"0123456789XYZGMRN=()[]\";:/.-+*$\n "[numbers.below(33)],
                1 => {
                    text.remove(at);
                }
                2 => {
                    let end = (at + numbers.below(40)).min(text.len());
                    let piece = text[at..end].to_vec();
                    let to = numbers.below(text.len());
                    text.splice(to..to, piece);
                }
                _ => text.truncate(text.len().min(at + 20)),
            }
            if text.is_empty() {
                break;
            }
        }
        must_end(&text, &short());
    }
}

#[test]
fn long_texts_take_little_time() {
    let line = |piece: &str, n: usize| piece.repeat(n);
    let texts = [
        line("R1=1 ", 200_000),
        line("M6", 500_000),
        line("R1=1+", 1) + &line("1+", 500_000) + "1",
        line("G1X1", 250_000),
        line("%A\n", 300_000),
        line("AA:\n", 250_000) + "REPEAT AA P=100000",
        line("AA:\n", 250_000) + "GOTOB AA",
        line("LOOP\n", 200_000),
        line("IF 1\n", 100_000) + &line("ENDIF\n", 100_000),
        String::from("LOOP\nG1 X1 F1\nMCALL CYCLE83(99,0,1,-99,,-0.001)\nG0 X1\nENDLOOP"),
        String::from("LOOP\nHOLES2(0,0,5,0,0,9999)\nENDLOOP"),
        String::from("LOOP\nSUB_A\nENDLOOP\nM30\nPROC SUB_A\nDEF REAL FIELD[9999]\nRET"),
        line("MSG(", 200_000),
        line("\"", 300_001),
        line("X=", 300_000),
        line("G4 F1\n", 200_000),
        line("G505\nG506\n", 100_000),
        line("RNDM=1 G1 X1 F1\nY1\nX0\nY0\n", 20_000),
        line("DEF REAL AB\n", 100_000),
        String::from("CASE 1 OF ") + &line("2 GOTOF AA ", 80_000),
    ];
    for text in texts {
        must_end(text.as_bytes(), &Budget::unlimited());
    }
}
