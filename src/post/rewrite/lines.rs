//! Cuts a text into lines. A line ends with LF, with CR and LF, or with CR alone.

/// The longest line that is read, bytes with the line end. Bounds the memory that one line takes.
pub const MAX_LINE_LENGTH: usize = 64 * 1024;

/// The end of the first line of `bytes`, behind its line end. `None` where no line ends for certain: behind a
/// CR at the end of the bytes, an LF may come.
fn first_end(bytes: &[u8]) -> Option<usize> {
    let at = bytes.iter().position(|c| matches!(c, b'\n' | b'\r'))?;
    match (bytes[at], bytes.get(at + 1)) {
        (b'\r', None) => None,
        (b'\r', Some(b'\n')) => Some(at + 2),
        _ => Some(at + 1),
    }
}

/// The lines of a whole text, each with its line end, which the last line may lack.
pub fn split(mut text: &[u8]) -> impl Iterator<Item = &[u8]> {
    std::iter::from_fn(move || {
        let (line, rest) = text.split_at(first_end(text).unwrap_or(text.len()));
        text = rest;
        Some(line).filter(|line| !line.is_empty())
    })
}

/// How many bytes of a text are lines that have ended for certain.
pub fn whole(text: &[u8]) -> usize {
    // A CR at the end may be the first half of a line end.
    let certain = text.strip_suffix(b"\r").unwrap_or(text);
    certain.iter().rposition(|c| matches!(c, b'\n' | b'\r')).map_or(0, |at| at + 1)
}

/// The line end of `line`.
pub fn line_end(line: &[u8]) -> &'static [u8] {
    match line {
        [.., b'\r', b'\n'] => b"\r\n",
        [.., b'\n'] => b"\n",
        [.., b'\r'] => b"\r",
        _ => b"",
    }
}

/// Collects lines of a text that comes in pieces.
#[derive(Debug, Default)]
pub struct Cutter {
    /// The start of a line whose end has not come yet.
    partial: Vec<u8>,
    n_lines: u64,
}

/// A line is longer than [`MAX_LINE_LENGTH`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooLong {
    /// From 1.
    pub line: u64,
}

impl Cutter {
    /// Passes each line that ends within the next `bytes` to `take`.
    ///
    /// # Errors
    /// Those of `take`, and [`TooLong`].
    pub fn push<E: From<TooLong>>(
        &mut self,
        mut bytes: &[u8],
        mut take: impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        if self.partial.ends_with(b"\r") && !bytes.is_empty() {
            if let Some(rest) = bytes.strip_prefix(b"\n") {
                self.partial.push(b'\n');
                bytes = rest;
            }
            self.finish(&mut take)?;
        }
        while !bytes.is_empty() {
            let end = first_end(bytes);
            let (line, rest) = bytes.split_at(end.unwrap_or(bytes.len()));
            bytes = rest;
            self.check(line.len())?;
            if end.is_some() && self.partial.is_empty() {
                self.n_lines += 1;
                take(line)?;
                continue;
            }
            self.partial.extend_from_slice(line);
            if end.is_some() {
                self.finish(&mut take)?;
            }
        }
        Ok(())
    }

    /// Passes the line that has begun to `take`, if there is one.
    ///
    /// # Errors
    /// As [`Cutter::push`].
    pub fn finish<E: From<TooLong>>(
        &mut self,
        mut take: impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        self.check(0)?;
        if !self.partial.is_empty() {
            self.n_lines += 1;
            take(&self.partial)?;
            self.partial.clear();
        }
        Ok(())
    }

    /// Whether `more` bytes fit the line that has begun.
    fn check(&self, more: usize) -> Result<(), TooLong> {
        let fits = self.partial.len() + more <= MAX_LINE_LENGTH;
        if fits { Ok(()) } else { Err(TooLong { line: self.n_lines + 1 }) }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cut(text: &[u8], piece: usize) -> Result<Vec<Vec<u8>>, TooLong> {
        let (mut cutter, mut lines) = (Cutter::default(), Vec::new());
        let mut take = |line: &[u8]| {
            lines.push(line.to_vec());
            Ok::<_, TooLong>(())
        };
        for bytes in text.chunks(piece) {
            cutter.push(bytes, &mut take)?;
        }
        cutter.finish(&mut take)?;
        Ok(lines)
    }

    #[test]
    fn lines_end_with_lf_cr_lf_or_cr() {
        let text = b"a\nb\r\nc\rd\r\r\n\n\re";
        let lines: Vec<&[u8]> = vec![b"a\n", b"b\r\n", b"c\r", b"d\r", b"\r\n", b"\n", b"\r", b"e"];
        for piece in 1..9 {
            assert_eq!(cut(text, piece).as_ref(), Ok(&lines.iter().map(|line| line.to_vec()).collect()));
        }
        assert_eq!(split(text).collect::<Vec<_>>(), lines);
        assert_eq!(
            (line_end(b"b\r\n"), line_end(b"c\r"), line_end(b"e")),
            (b"\r\n".as_slice(), b"\r".as_slice(), b"".as_slice())
        );
    }

    #[test]
    fn a_long_line_is_refused_however_it_comes() {
        let long = [b"a\n".as_slice(), &[b'1'; MAX_LINE_LENGTH]].concat();
        for piece in [7, 4096, 100_000] {
            assert_eq!(cut(&[&long, b"\n".as_slice()].concat(), piece), Err(TooLong { line: 2 }));
            assert_eq!(cut(&[&long, b"\r".as_slice()].concat(), piece), Err(TooLong { line: 2 }));
            assert!(cut(&long, piece).is_ok());
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn whole_lines_are_those_before_the_last_certain_end(text in "[a\r\n]{0,12}") {
            let text = text.as_bytes();
            let whole = whole(text);
            let lines = split(&text[..whole]).collect::<Vec<_>>();
            prop_assert!(lines.iter().all(|line| !line_end(line).is_empty()));
            prop_assert_eq!(lines.concat(), &text[..whole]);
            let rest = text[whole..].strip_suffix(b"\r").unwrap_or(&text[whole..]);
            prop_assert!(!rest.contains(&b'\n') && !rest.contains(&b'\r'));
        }
    }
}
