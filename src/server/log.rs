//! Writes log lines on a thread of their own. A log that cannot be written, because the disk is full or
//! nobody reads the pipe, costs lines and nothing else: no request waits for the log.

use std::io::{self, Write};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

/// Most lines that wait to be written. Further lines are lost.
const WAITING_LINES: usize = 2048;

/// How long the end of the program waits for the last lines.
const LAST_LINES: Duration = Duration::from_millis(500);

/// Takes lines for the log. Clones write to the same log.
#[derive(Debug, Clone)]
pub struct Writer(SyncSender<Message>);

#[derive(Debug)]
enum Message {
    Line(Vec<u8>),
    End,
}

impl Write for Writer {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        // A line that finds no room is lost.
        let _ = self.0.try_send(Message::Line(line.to_vec()));
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The lines that wait to be written.
#[derive(Debug)]
pub struct Lines {
    writer: Writer,
    ended: Receiver<()>,
}

impl Lines {
    /// Writes the lines that wait, unless that takes longer than half a second.
    pub fn finish(self) {
        if self.writer.0.try_send(Message::End).is_ok() {
            let _ = self.ended.recv_timeout(LAST_LINES);
        }
    }
}

/// A log whose lines go to `target`.
///
/// # Errors
/// When the thread cannot be started.
pub fn lines(mut target: impl Write + Send + 'static) -> io::Result<(Lines, Writer)> {
    let (sender, messages) = sync_channel(WAITING_LINES);
    let (tell_ended, ended) = sync_channel(1);
    thread::Builder::new().name("log".into()).spawn(move || {
        while let Ok(Message::Line(line)) = messages.recv() {
            // A line that cannot be written is lost.
            let _ = target.write_all(&line);
        }
        let _ = tell_ended.send(());
    })?;
    let writer = Writer(sender);
    Ok((Lines { writer: writer.clone(), ended }, writer))
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};
    use std::time::Instant;

    use super::*;

    #[derive(Clone, Default)]
    struct Shared(Arc<Mutex<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().expect("no panic").write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    struct Stuck;

    impl Write for Stuck {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            loop {
                thread::park();
            }
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn lines_are_written_in_order_before_the_end() {
        let written = Shared::default();
        let (lines, mut writer) = lines(written.clone()).expect("a thread");
        for k in 0..100 {
            writeln!(writer, "line {k}").expect("taken");
        }
        lines.finish();
        let text = String::from_utf8(written.0.lock().expect("no panic").clone()).expect("UTF-8");
        let expected: String = (0..100).map(|k| format!("line {k}\n")).collect();
        // `writeln!` may write a line in parts, which stay in order.
        assert_eq!(text, expected);
    }

    /// Most tries. A busy machine delays some of them, and a log that waits of itself waits in all.
    const TRIES: usize = 10;

    #[test]
    fn a_log_that_takes_nothing_holds_up_neither_its_writers_nor_the_end() {
        let mut tries = (0..TRIES).map(|_| {
            let begun = Instant::now();
            let (lines, mut writer) = lines(Stuck).expect("a thread");
            for _ in 0..10 * WAITING_LINES {
                writer.write_all(b"lost\n").expect("taken");
            }
            lines.finish();
            begun.elapsed()
        });
        assert!(tries.any(|took| took < 4 * LAST_LINES), "each try took longer");
    }
}
