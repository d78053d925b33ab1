//! A program together with whatever it starts.

use std::io;
use std::process::{Child, Command, ExitStatus};

/// A program in a process group of its own. All of the group ends with this value: what a reasoner starts does not outlive its
/// turn, unless it left the group (`setsid`). Where there are no process groups only the program itself is ended.
pub(super) struct Group {
    child: Child,
    ended: bool,
}

impl Group {
    pub fn start(command: &mut Command) -> io::Result<Self> {
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        Ok(Self { child: command.spawn()?, ended: false })
    }

    pub fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// Whether the program has ended. It is not reaped by that, so its id still names its group and no other.
    #[cfg(unix)]
    pub fn has_ended(&mut self) -> io::Result<bool> {
        use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        Ok(waitid(WaitId::Pid(Pid::from_child(&self.child)), options)?.is_some())
    }

    /// Whether the program has ended.
    #[cfg(not(unix))]
    pub fn has_ended(&mut self) -> io::Result<bool> {
        Ok(self.child.try_wait()?.is_some())
    }

    /// Ends what still runs of the group, and gives how the program ended.
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

impl Drop for Group {
    fn drop(&mut self) {
        if !self.ended {
            let _ = self.end();
        }
    }
}
