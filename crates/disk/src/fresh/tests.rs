use std::fs;

use super::*;

/// Entries of a folder.
fn count(folder: &Path) -> usize {
    fs::read_dir(folder).unwrap().count()
}

#[test]
fn a_file_that_is_not_kept_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let fresh = Fresh::new(&path).unwrap();
    fresh.file().unwrap().write_all(b"half").unwrap();
    assert!(!path.exists());
    drop(fresh);
    assert_eq!(count(folder.path()), 0);
    let mut fresh = Fresh::new(&path).unwrap();
    fresh.sync_early().unwrap();
    fresh.file().unwrap().write_all(b"whole").unwrap();
    fresh.keep().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"whole");
    assert_eq!(count(folder.path()), 1);
}

#[test]
fn a_folder_is_refused_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let error = write(folder.path(), b"x").unwrap_err();
    assert_eq!(error.to_string(), "it is a folder; name a file in it");
    assert!(write(&folder.path().join("none/a"), b"x").is_err());
    assert_eq!(count(folder.path()), 0);
}

#[test]
fn a_file_that_is_made_does_not_replace_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    create(&path, b"first").unwrap();
    assert_eq!(create(&path, b"second").unwrap_err().kind(), io::ErrorKind::AlreadyExists);
    assert_eq!(fs::read(&path).unwrap(), b"first");
    probe(folder.path()).unwrap();
    assert!(probe(&folder.path().join("none")).is_err());
    assert_eq!(count(folder.path()), 1);
}

#[cfg(unix)]
mod unix {
    use std::io::Read;
    use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, chown, symlink};
    use std::os::unix::net::UnixListener;
    use std::process::Command;

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().mode() & 0o7777
    }

    fn run(program: &str, args: &[&str], path: &Path) -> bool {
        Command::new(program).arg(path).args(args).output().is_ok_and(|output| output.status.success())
    }

    #[test]
    fn mode_and_owner_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "before").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o651)).unwrap();
        // Only root can give a file away; without that the owner is the one who runs the test.
        let given = chown(&path, Some(4321), Some(1234)).is_ok();
        let owner = |path: &Path| fs::metadata(path).map(|m| (m.uid(), m.gid())).unwrap();
        let before = owner(&path);
        write(&path, b"after").unwrap();
        assert_eq!((mode(&path), owner(&path)), (0o651, before));
        assert_eq!(fs::read(&path).unwrap(), b"after");
        assert!(!given || before == (4321, 1234));
        assert_eq!(count(folder.path()), 1);
        // A new file has the mode that any program would give it.
        let (ours, other) = (folder.path().join("new"), folder.path().join("other"));
        write(&ours, b"x").unwrap();
        fs::write(&other, "x").unwrap();
        assert_eq!(mode(&ours), mode(&other));
    }

    #[test]
    fn a_link_stays_and_its_target_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("sub")).unwrap();
        fs::write(at("sub/a"), "before").unwrap();
        fs::set_permissions(at("sub/a"), fs::Permissions::from_mode(0o640)).unwrap();
        symlink("sub/a", at("link")).unwrap();
        symlink("link", at("twice")).unwrap();
        write(&at("twice"), b"after").unwrap();
        assert_eq!(fs::read(at("sub/a")).unwrap(), b"after");
        assert_eq!(mode(&at("sub/a")), 0o640);
        // One that leads nowhere makes the file there.
        symlink("sub/new", at("dangling")).unwrap();
        symlink("dangling", at("dangling twice")).unwrap();
        write(&at("dangling twice"), b"new").unwrap();
        assert_eq!(fs::read(at("sub/new")).unwrap(), b"new");
        for link in ["link", "twice", "dangling", "dangling twice"] {
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
        }
        symlink("round", at("round")).unwrap();
        assert!(write(&at("round"), b"x").is_err());
        assert_eq!((count(folder.path()), count(&at("sub"))), (6, 2));
    }

    #[test]
    fn a_read_only_file_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "before").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        assert_eq!(write(&path, b"after").unwrap_err().to_string(), "it is read-only; make it writable first");
        assert_eq!(fs::read(&path).unwrap(), b"before");
    }

    #[test]
    fn a_pipe_gets_everything_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        assert!(run("mkfifo", &[], &path), "no pipe can be made here");
        let reader = std::thread::spawn({
            let path = path.clone();
            move || fs::read(path).unwrap()
        });
        // More than a pipe holds at a time.
        let bytes = vec![7; 1 << 20];
        write(&path, &bytes).unwrap();
        assert_eq!(reader.join().unwrap(), bytes);
        assert!(fs::metadata(&path).unwrap().file_type().is_fifo());
        assert_eq!(count(folder.path()), 1);
    }

    #[test]
    fn a_socket_gets_everything_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("socket");
        let listener = UnixListener::bind(&path).unwrap();
        let reader = std::thread::spawn(move || {
            let mut bytes = Vec::new();
            listener.accept().unwrap().0.read_to_end(&mut bytes).unwrap();
            bytes
        });
        write(&path, b"report").unwrap();
        assert_eq!(reader.join().unwrap(), b"report");
        assert!(fs::metadata(&path).unwrap().file_type().is_socket());
        // Nobody listens any more, once processes that other tests began here have given the listener up.
        let refused = |_| {
            write(&path, b"report").is_err() || {
                std::thread::sleep(EVERY);
                false
            }
        };
        assert!((0..100).any(refused));
        assert_eq!(count(folder.path()), 1);
    }

    #[test]
    fn a_device_is_written_to_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        // As root with a copy of the device: a fault here would replace the machine's own.
        let copy = folder.path().join("null");
        let made = run("mknod", &["c", "1", "3"], &copy) && fs::write(&copy, "x").is_ok();
        let path = if made { &copy } else { Path::new("/dev/null") };
        let link = folder.path().join("link");
        symlink(path, &link).unwrap();
        let before = fs::metadata(path).unwrap();
        write(path, b"report").unwrap();
        write(&link, b"report").unwrap();
        let mut fresh = Fresh::new(path).unwrap();
        fresh.sync_early().unwrap();
        fresh.file().unwrap().write_all(b"report").unwrap();
        fresh.keep_unsynced().unwrap();
        let after = fs::metadata(path).unwrap();
        assert!(after.file_type().is_char_device());
        assert_eq!((after.ino(), after.rdev(), after.mode()), (before.ino(), before.rdev(), before.mode()));
        assert_eq!(count(folder.path()), 1 + usize::from(made));
    }

    #[test]
    fn a_file_in_a_folder_that_takes_no_new_one_is_written_in_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "longer than after").unwrap();
        let inode = fs::metadata(&path).unwrap().ino();
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o555)).unwrap();
        write(&path, b"after").unwrap();
        // Root may make files in every folder, and replaces the file.
        let kept = fs::metadata(&path).unwrap().ino() == inode;
        assert!(kept || probe(folder.path()).is_ok());
        assert_eq!(fs::read(&path).unwrap(), b"after");
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o755)).unwrap();
    }

    #[test]
    fn what_cannot_be_renamed_is_copied() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "longer than after").unwrap();
        let to = fs::OpenOptions::new().write(true).open(&path).unwrap();
        let mut from = tempfile::tempfile().unwrap();
        from.write_all(b"after").unwrap();
        Target::Copied { to, regular: true }.give(&mut from, true).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"after");
    }
}
