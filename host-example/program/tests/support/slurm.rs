//! A cluster of Slurm on this machine: a controller and one node, by the machine's own packages.

use std::fs;
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::{folder, succeeds};

/// Longest time that a state is waited for. A task that runs again waits for 5 seconds, and a node is given up after 3.
const LONGEST: Duration = Duration::from_secs(120);

/// The daemons.
const CONTROLLER: &str = "/usr/sbin/slurmctld";
const NODE: &str = "/usr/sbin/slurmd";

/// The cluster; it ends with this value, and with it all that runs on it.
pub struct Cluster {
    folder: TempDir,
    controller: Child,
    node: Child,
}

impl Cluster {
    /// Starts one and waits until its node is idle; none where there is no Slurm, which fails where it must be.
    pub fn start() -> Option<Self> {
        if !(Path::new(CONTROLLER).exists() && Path::new(NODE).exists()) {
            assert!(std::env::var("CI").is_err(), "Slurm is missing; install slurm-wlm");
            eprintln!("\n*** SKIPPED: jobs of Slurm need slurm-wlm ***\n");
            return None;
        }
        let folder = folder();
        let at = folder.path();
        for name in ["state", "spool"] {
            fs::create_dir(at.join(name)).expect("the folder is writable");
        }
        fs::write(at.join("slurm.conf"), configuration(at)).expect("the folder is writable");
        let controller = daemon(at, CONTROLLER, &[]);
        let node = daemon(at, NODE, &["-N", "localhost"]);
        let cluster = Self { folder, controller, node };
        cluster.wait("the node to be idle", || cluster.node_state() == "idle");
        Some(cluster)
    }

    /// A program of Slurm that speaks to this cluster.
    pub fn command(&self, name: &str) -> Command {
        let mut command = Command::new(name);
        command.env("SLURM_CONF", self.folder.path().join("slurm.conf"));
        command
    }

    /// State, restarts and exit code of an array's task.
    pub fn task(&self, job: &str, task: usize) -> [String; 3] {
        let shown = self.output("scontrol", &["-o", "show", "job", &format!("{job}_{task}")]);
        ["JobState", "Restarts", "ExitCode"].map(|name| {
            let value = shown.split_whitespace().find_map(|word| word.strip_prefix(&format!("{name}=")));
            value.unwrap_or_default().to_owned()
        })
    }

    /// Waits until something holds.
    pub fn wait(&self, what: &str, mut holds: impl FnMut() -> bool) {
        let started = Instant::now();
        while !holds() {
            let log = || fs::read_to_string(self.folder.path().join("log")).unwrap_or_default();
            assert!(started.elapsed() < LONGEST, "waited too long for {what}: {}", log());
            std::thread::sleep(Duration::from_millis(200));
        }
    }

    /// Kills the node with all that runs on it, as a machine dies that loses its power, and starts it again when the cluster has
    /// given it up.
    pub fn lose_node(&mut self) {
        self.kill_others();
        self.node.wait().expect("the node was started");
        self.wait("the node to be down", || self.node_state().starts_with("down"));
        self.node = daemon(self.folder.path(), NODE, &["-N", "localhost"]);
    }

    fn node_state(&self) -> String {
        self.output("sinfo", &["-h", "-o", "%T"]).trim().to_owned()
    }

    fn output(&self, name: &str, arguments: &[&str]) -> String {
        let output = self.command(name).args(arguments).output().expect("Slurm's programs can be started");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Kills everything of the cluster but its controller: what has its configuration among its variables.
    fn kill_others(&self) {
        let mark = self.folder.path().join("slurm.conf").into_os_string().into_encoded_bytes();
        let is_other = |id: &u32| {
            // A process that has ended meanwhile has no variables.
            let variables = fs::read(format!("/proc/{id}/environ")).unwrap_or_default();
            *id != self.controller.id() && variables.windows(mark.len()).any(|part| part == mark)
        };
        let processes = fs::read_dir("/proc").expect("/proc").flatten();
        let processes = processes.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
        let others: Vec<String> = processes.filter(is_other).map(|id: u32| id.to_string()).collect();
        Command::new("kill")
            .arg("-9")
            .args(others)
            .stderr(Stdio::null())
            .status()
            .expect("kill can be started");
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        self.kill_others();
        for daemon in [&mut self.node, &mut self.controller] {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

fn daemon(folder: &Path, program: &str, more: &[&str]) -> Child {
    let log = fs::File::options().create(true).append(true).open(folder.join("log")).expect("a log");
    let mut command = Command::new(program);
    command.arg("-D").args(more).env("SLURM_CONF", folder.join("slurm.conf")).current_dir(folder);
    let output = log.try_clone().expect("a log");
    command.stdin(Stdio::null()).stdout(output).stderr(log).spawn().expect("the daemon can be started")
}

/// Configuration of a cluster of this machine alone, without keys and groups of control, for the user who tests.
fn configuration(folder: &Path) -> String {
    let ports: Vec<TcpListener> =
        (0..2).map(|_| TcpListener::bind("127.0.0.1:0").expect("a free port")).collect();
    let [controller, node] =
        [&ports[0], &ports[1]].map(|port| port.local_addr().expect("a port has a number").port());
    let user = succeeds(Command::new("id").arg("-un")).0;
    let (user, folder) = (user.trim(), folder.display());
    format!(
        "ClusterName=test
SlurmctldHost=localhost
SlurmctldPort={controller}
SlurmdPort={node}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
CredType=cred/none
AuthInfo=cred_expire=5
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
ReturnToService=2
SlurmctldPidFile={folder}/controller.pid
SlurmdPidFile={folder}/node.pid
SlurmdSpoolDir={folder}/spool
StateSaveLocation={folder}/state
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=1,batch_sched_delay=0
SlurmdParameters=config_overrides
SlurmdTimeout=3
KillWait=2
NodeName=localhost NodeHostname=localhost CPUs=2 RealMemory=1000
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"
    )
}
