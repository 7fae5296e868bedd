//! How a character is framed on a serial line: data bits, parity and stop bits.

use std::fmt;
use std::str::FromStr;

/// The parity bit of a character.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parity {
    None,
    Even,
    Odd,
}

/// The frame of a character, such as 7E2: seven data bits, even parity, two stop bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Format {
    pub has_seven_bits: bool,
    pub parity: Parity,
    pub has_two_stops: bool,
}

impl Format {
    /// 8N1, which most computers and GRBL use.
    pub const EIGHT_N_ONE: Self = Self { has_seven_bits: false, parity: Parity::None, has_two_stops: false };

    /// Bits that a character takes on the line, with its start bit.
    pub fn bits(self) -> u32 {
        let data = if self.has_seven_bits { 7 } else { 8 };
        let parity = u32::from(self.parity != Parity::None);
        let stop = if self.has_two_stops { 2 } else { 1 };
        1 + data + parity + stop
    }

    /// Characters a second at `baud` bits a second.
    pub fn characters_per_s(self, baud: u32) -> f64 {
        f64::from(baud) / f64::from(self.bits())
    }

    /// Whether a character of this format can hold `byte`.
    pub fn carries(self, byte: u8) -> bool {
        !self.has_seven_bits || byte < 0x80
    }

    /// The data bits of a received byte. Some ports leave the parity in the eighth bit.
    pub fn data(self, byte: u8) -> u8 {
        if self.has_seven_bits { byte & 0x7f } else { byte }
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [data, parity, stop] = *text.as_bytes() else {
            return Err(unknown(text));
        };
        Ok(Self {
            has_seven_bits: match data {
                b'7' => true,
                b'8' => false,
                _ => return Err(unknown(text)),
            },
            parity: match parity.to_ascii_lowercase() {
                b'n' => Parity::None,
                b'e' => Parity::Even,
                b'o' => Parity::Odd,
                _ => return Err(unknown(text)),
            },
            has_two_stops: match stop {
                b'1' => false,
                b'2' => true,
                _ => return Err(unknown(text)),
            },
        })
    }
}

fn unknown(text: &str) -> String {
    format!("`{text}` is not a format; write data bits (7, 8), parity (n, e, o) and stop bits (1, 2): `7e2`")
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let data = if self.has_seven_bits { 7 } else { 8 };
        let parity = match self.parity {
            Parity::None => 'n',
            Parity::Even => 'e',
            Parity::Odd => 'o',
        };
        write!(f, "{data}{parity}{}", if self.has_two_stops { 2 } else { 1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The levels of the line for one character, as a UART makes them: start bit, data from the lowest bit,
    /// parity, stop bits.
    fn levels(format: Format, byte: u8) -> Vec<bool> {
        assert!(format.carries(byte));
        let n_data = if format.has_seven_bits { 7 } else { 8 };
        let data: Vec<bool> = (0..n_data).map(|k| byte >> k & 1 == 1).collect();
        let is_odd = data.iter().filter(|bit| **bit).count() % 2 == 1;
        let mut levels = vec![false];
        levels.extend(&data);
        match format.parity {
            Parity::None => {}
            Parity::Even => levels.push(is_odd),
            Parity::Odd => levels.push(!is_odd),
        }
        levels.extend(vec![true; if format.has_two_stops { 2 } else { 1 }]);
        levels
    }

    fn all() -> Vec<Format> {
        let names = ["7n1", "7n2", "7e1", "7e2", "7o1", "7o2", "8n1", "8n2", "8e1", "8e2", "8o1", "8o2"];
        names.iter().map(|name| name.parse().expect("a format")).collect()
    }

    #[test]
    fn a_format_takes_as_many_bits_as_a_uart_sends_for_a_character() {
        for format in all() {
            for byte in (0..=255).filter(|byte| format.carries(*byte)) {
                assert_eq!(levels(format, byte).len(), format.bits() as usize, "{format}");
            }
        }
        let format: Format = "7e2".parse().expect("a format");
        assert_eq!(format.bits(), 11);
        assert_eq!(format.characters_per_s(9600).round(), 873.0);
        assert_eq!(Format::EIGHT_N_ONE.characters_per_s(115_200), 11_520.0);
    }

    #[test]
    fn the_parity_makes_the_count_of_ones_even_or_odd_and_masking_removes_it() {
        for format in all() {
            for byte in (0..=255).filter(|byte| format.carries(*byte)) {
                let levels = levels(format, byte);
                let n_data = if format.has_seven_bits { 7 } else { 8 };
                let checked = 1..1 + n_data + usize::from(format.parity != Parity::None);
                let ones = levels[checked].iter().filter(|bit| **bit).count();
                match format.parity {
                    Parity::None => {}
                    Parity::Even => assert_eq!(ones % 2, 0),
                    Parity::Odd => assert_eq!(ones % 2, 1),
                }
                assert_eq!(format.data(byte), byte);
                // A port that passes on the parity in the eighth bit.
                if format.has_seven_bits {
                    assert_eq!(format.data(byte | 0x80), byte);
                }
            }
        }
    }

    #[test]
    fn seven_bits_carry_ascii_alone() {
        for format in all() {
            assert!(format.carries(0x7f));
            assert_eq!(format.carries(0x80), !format.has_seven_bits);
        }
    }

    #[test]
    fn names_are_read_as_they_are_written_and_others_are_refused() {
        for format in all() {
            assert_eq!(format.to_string().parse(), Ok(format));
            assert_eq!(format.to_string().to_uppercase().parse(), Ok(format));
        }
        for wrong in ["", "7e", "9n1", "8x1", "8n3", "8n12", "8\u{e9}"] {
            assert!(wrong.parse::<Format>().is_err(), "{wrong}");
        }
    }
}
