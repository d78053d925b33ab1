//! A program together with whatever it starts: for policies and reasoners that are programs of their own.

use std::io;
use std::process::{Child, Command, ExitStatus};

/// A program in a process group of its own. All of the group ends with this value: what the program starts does not outlive it,
/// unless it left the group (`setsid`). Where there are no process groups only the program itself is ended.
#[derive(Debug)]
pub struct ProcessGroup {
    child: Child,
    ended: bool,
}

impl ProcessGroup {
    /// Starts `command` as the leader of a new group.
    ///
    /// # Errors
    /// A program that does not exist or cannot be started.
    pub fn start(command: &mut Command) -> io::Result<Self> {
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        Ok(Self { child: command.spawn()?, ended: false })
    }

    /// The program.
    pub fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// Whether the program has ended. It is not reaped by that, so its id still names its group and no other.
    ///
    /// # Errors
    /// The operating system cannot tell.
    #[cfg(unix)]
    pub fn has_ended(&mut self) -> io::Result<bool> {
        use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        Ok(waitid(WaitId::Pid(Pid::from_child(&self.child)), options)?.is_some())
    }

    /// Whether the program has ended.
    ///
    /// # Errors
    /// The operating system cannot tell.
    #[cfg(not(unix))]
    pub fn has_ended(&mut self) -> io::Result<bool> {
        Ok(self.child.try_wait()?.is_some())
    }

    /// Ends what still runs of the group, and gives how the program ended.
    ///
    /// # Errors
    /// The operating system cannot tell how.
    pub fn end(&mut self) -> io::Result<ExitStatus> {
        self.kill();
        self.ended = true;
        self.child.wait()
    }

    fn kill(&mut self) {
        // Who has ended by itself in this moment cannot be killed any more, and need not be.
        #[cfg(unix)]
        let _ = rustix::process::kill_process_group(rustix::process::Pid::from_child(&self.child), rustix::process::Signal::KILL);
        let _ = self.child.kill();
    }
}

impl Drop for ProcessGroup {
    fn drop(&mut self) {
        if !self.ended {
            let _ = self.end();
        }
    }
}
