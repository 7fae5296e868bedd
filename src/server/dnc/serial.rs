//! A serial port in raw mode. The kernel's own handshake by XON and XOFF is off: it stops its output queue,
//! which holds thousands of characters, and IXANY would take any character of the control for XON.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::time::Duration;

use rustix::fs::OFlags;
use serialport::{ClearBuffer, DataBits, FlowControl, SerialPort, StopBits, TTYPort};

use super::format::Parity;
use super::line::{Line, more, wait_for, without_blocking};
use super::sender::Delivery;
use super::settings::{Flow, Settings};

/// An open serial port.
#[derive(Debug)]
pub struct Serial {
    /// Reads and writes without blocking.
    file: File,
    /// Holds the settings of the same port, and tells of its output queue.
    port: TTYPort,
}

impl Serial {
    /// Opens the device at `path` for this process alone.
    ///
    /// # Errors
    /// When there is no such device, another program uses it, or it cannot have these settings.
    pub fn open(path: &str, settings: &Settings) -> io::Result<Self> {
        // The device is opened twice, because `TTYPort` blocks when the system has no room. The second
        // opening locks the device, so it comes last.
        let flags = (OFlags::NONBLOCK | OFlags::NOCTTY).bits();
        let flags = i32::try_from(flags).map_err(io::Error::other)?;
        let file = File::options().read(true).write(true).custom_flags(flags).open(path)?;
        let format = settings.format();
        let builder = serialport::new(path, settings.baud())
            .data_bits(if format.has_seven_bits { DataBits::Seven } else { DataBits::Eight })
            .parity(match format.parity {
                Parity::None => serialport::Parity::None,
                Parity::Even => serialport::Parity::Even,
                Parity::Odd => serialport::Parity::Odd,
            })
            .stop_bits(if format.has_two_stops { StopBits::Two } else { StopBits::One })
            .flow_control(match settings.flow {
                Flow::RtsCts => FlowControl::Hardware,
                Flow::None | Flow::XonXoff | Flow::Grbl => FlowControl::None,
            });
        let port = TTYPort::open(&builder)?;
        // An XOFF that came before the port was opened concerns an earlier sender.
        port.clear(ClearBuffer::Input)?;
        Ok(Self { file, port })
    }
}

impl Line for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        more(self.file.read(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        without_blocking(self.file.write(bytes))
    }

    fn queued(&self) -> io::Result<usize> {
        Ok(self.port.bytes_to_write()? as usize)
    }

    fn wait(&self, for_room: bool, time: Duration) -> io::Result<()> {
        wait_for(&self.file, for_room, time)
    }

    fn discard(&mut self) -> io::Result<()> {
        Ok(self.port.clear(ClearBuffer::Output)?)
    }

    fn finish(&mut self) -> io::Result<Delivery> {
        Ok(Delivery::Transmitted)
    }
}
