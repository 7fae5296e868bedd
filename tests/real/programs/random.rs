//! Random programs for LinuxCNC.

/// A generator of numbers by Steele and Vigna (SplitMix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    /// A number of the grid of a quarter in -20..=20.
    fn place(&mut self) -> f64 {
        self.below(161) as f64 / 4.0 - 20.0
    }
}

/// A program that the interpreter reads.
pub fn program(seed: u64) -> String {
    let mut numbers = Numbers(seed);
    let inches = numbers.below(4) == 0;
    let mut text =
        format!("G{} G17 G90 G94 G40 G80 G{}\n", if inches { 20 } else { 21 }, 98 + numbers.below(2));
    text += "G0 X0 Y0 Z5\nM3 S1000\nG1 F300\n";
    let mut at = [0.0, 0.0, 5.0];
    for k in 0..12 {
        block(&mut text, &mut at, &mut numbers, k);
    }
    text += if seed.is_multiple_of(2) { "M2\n" } else { "M30\n" };
    text
}

fn block(text: &mut String, at: &mut [f64; 3], numbers: &mut Numbers, k: usize) {
    let to = [numbers.place(), numbers.place(), numbers.place()];
    let set = |at: &mut [f64; 3], axes: &[usize]| axes.iter().for_each(|axis| at[*axis] = to[*axis]);
    let [x, y, z] = to;
    match numbers.below(17) {
        0 => {
            *text += &format!("G0 X{x} Y{y} Z{z}\n");
            set(at, &[0, 1, 2]);
        }
        1 => {
            *text += &format!("g1 x{x} y[{y}+0] f{}\n", 100 + numbers.below(500));
            set(at, &[0, 1]);
        }
        2 => {
            *text += &format!("G91 G1 X{x} Z{z}\nG90\n");
            (at[0], at[2]) = (at[0] + x, at[2] + z);
        }
        3 => *text += &format!("G17 G3 X{} Y{} I{} J{}\n", at[0], at[1], 1.0 + x.abs(), y),
        4 => *text += &format!("G17 G2 I{} J{} P{}\n", 1.0 + x.abs(), y, 1 + numbers.below(3)),
        5 => {
            // A half circle about the middle, or a helix.
            *text += &format!(
                "G17 G{} X{x} Y{y} Z{z} I{} J{}\n",
                2 + numbers.below(2),
                (x - at[0]) / 2.0,
                (y - at[1]) / 2.0
            );
            if x == at[0] && y == at[1] {
                *text = text
                    .trim_end()
                    .rsplit_once('\n')
                    .map_or(String::new(), |(before, _)| format!("{before}\n"));
                return;
            }
            set(at, &[0, 1, 2]);
        }
        6 => {
            let radius =
                ((x - at[0]).hypot(z - at[2]) / 2.0 + 1.0) * if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            if x == at[0] && z == at[2] {
                return;
            }
            *text += &format!("G18 G{} X{x} Z{z} R{radius:.4}\nG17\n", 2 + numbers.below(2));
            set(at, &[0, 2]);
        }
        7 => {
            *text += &format!("G19 G{} Y{} Z{} K{}\nG17\n", 2 + numbers.below(2), at[1], at[2] + 3.0, 1.5);
            at[2] += 3.0;
        }
        8 => *text += &format!("G4 P0.{}\n", 1 + numbers.below(9)),
        9 | 10 => {
            let code = [81, 82, 83, 73, 85, 86, 89, 84][numbers.below(8) as usize];
            let pause = if [82, 86, 89].contains(&code) { " P0.25" } else { "" };
            let peck = if [83, 73].contains(&code) { " Q0.75" } else { "" };
            *text += &format!(
                "G{code} X{x} Y{y} Z{} R{}{pause}{peck}\nX{}\nG80\n",
                at[2] - 5.0,
                at[2] - 1.0,
                x + 2.0
            );
            // Where the tool stands depends on G98 and G99.
            *text += &format!("G0 X{x} Y{y} Z{z}\n");
            set(at, &[0, 1, 2]);
        }
        11 => {
            let label = 100 + k;
            *text += &format!(
                "#1=0\no{label} while [#1 lt 3]\n#1=[#1+1]\nG91 G1 X[#1*0.5] Y-0.25\nG90\no{label} endwhile\n"
            );
            (at[0], at[1]) = (at[0] + 3.0, at[1] - 0.75);
        }
        12 => *text += &format!("G93 G1 X{} F{}\nG94 F250\n", at[0], 2 + numbers.below(5)),
        13 => {
            // The motion in force is no part of what comes back.
            *text += &format!("M70\nG91 G18 F77 G1 X{x}\nM72\nY{y}\n");
            (at[0], at[1]) = (at[0] + x, y);
        }
        14 => {
            let label = 300 + k;
            *text += &format!("o{label} sub\nM73\nG91 G1 X#1 F55\no{label} return [#1*2]\no{label} endsub\n");
            *text += &format!("o{label} call [{x}]\nG1 Y[#<_value>] Z[{z}+#<_value_returned>]\n");
            (at[0], at[1], at[2]) = (at[0] + x, 2.0 * x, z + 1.0);
        }
        15 => {
            let turn = numbers.below(720) as f64 / 2.0;
            *text += &format!("G10 L2 P1 R{turn}\nG1 X{x} Y{y}\nG17 G3 X{x} Y{} J1.5\nG1 Y{z}\n", y + 3.0);
            *text += &format!("G10 L2 P1 R0\nG0 X{x} Y{y} Z{z}\n");
            set(at, &[0, 1, 2]);
        }
        _ => {
            *text += &format!("G90.1 G3 X{} Y{} I{} J{}\nG91.1\n", at[0], at[1], at[0] + 2.0, at[1]);
        }
    }
}

/// A contour with cutter compensation that the interpreter reads, where the cutter fits: lines and arcs that turn
/// to both sides, moves along the normal and pauses between them.
pub fn compensated(seed: u64) -> String {
    let mut numbers = Numbers(seed ^ 0xc0de);
    let side = 41 + numbers.below(2);
    let mut text = String::from("G21 G17 G90 G94 G40 G80\nM3 S1000\nG0 X-30 Y-30 Z5\nG1 F300\n");
    let mut at = [-30.0, -30.0];
    text += &format!("G{side} D1 G{} X0 Y0\n", numbers.below(2));
    at = [at[0] + 30.0, at[1] + 30.0];
    let mut way = std::f64::consts::FRAC_PI_4;
    for _ in 0..5 + numbers.below(12) {
        let to = [numbers.place() * 2.0, numbers.place() * 2.0];
        let chord = (to[0] - at[0]).hypot(to[1] - at[1]);
        let toward = (to[1] - at[1]).atan2(to[0] - at[0]);
        // Cusps of two arcs are other corners for the interpreter than they are here.
        if chord < 8.0 || (toward - way).cos() < 0.2 {
            continue;
        }
        way = toward;
        match numbers.below(8) {
            0 => text += &format!("G0 X{} Y{}\n", to[0], to[1]),
            1 | 2 => {
                let radius = chord / 2.0 * (1.5 + numbers.below(5) as f64);
                text += &format!("G{} X{} Y{} R{radius:.4}\n", 2 + numbers.below(2), to[0], to[1]);
            }
            3 => text += &format!("G1 Z{}\nG1 X{} Y{}\n", numbers.place() / 8.0, to[0], to[1]),
            4 => text += &format!("G4 P0.25\nG1 X{} Y{}\n", to[0], to[1]),
            _ => text += &format!("G1 X{} Y{}\n", to[0], to[1]),
        }
        at = to;
    }
    match numbers.below(3) {
        0 => text += "G40 G1 X60 Y60\n",
        1 => text += "G40\nG0 Z20\nG0 X60 Y60\n",
        _ => {}
    }
    text + "M2\n"
}

/// The program with one word left out, doubled, or of another value.
pub fn changed(text: &str, seed: u64) -> String {
    let mut numbers = Numbers(seed ^ 0x5eed);
    let mut words: Vec<String> = text.replace('\n', " \n ").split(' ').map(str::to_owned).collect();
    let count = words.len() as u64;
    let k = (0..20).map(|_| numbers.below(count) as usize).find(|k| words[*k].len() > 1).unwrap_or(0);
    let letter = words[k].chars().next().unwrap_or('X');
    match numbers.below(5) {
        0 => words[k] = String::new(),
        1 => words[k] = format!("{0} {0}", words[k]),
        2 => words[k] = format!("{letter}{}", numbers.below(100)),
        3 => {
            words[k] = format!(
                "{}{}",
                ["G", "X", "P", "R", "I", "Q", "M", "F"][numbers.below(8) as usize],
                numbers.below(60)
            )
        }
        _ => words[k] = format!("{letter}-{}.5", numbers.below(30)),
    }
    words.join(" ").replace(" \n ", "\n")
}
