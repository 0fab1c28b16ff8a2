//! Includes, paths of assets, and the folder that nothing leaves.

use super::*;
use myo_mjcf::{FileError, Folder};
use std::fs;
use std::path::Path;

#[test]
fn includes_are_spliced_wherever_they_stand() {
    let model = read_files(&[
        ("a/m.xml", "<mujoco><include file='parts/d.xml'/><worldbody><body><include file='parts/g.xml'/></body></worldbody></mujoco>"),
        ("a/parts/d.xml", "<mujocoinclude><default><include file='deep/e.xml'/></default></mujocoinclude>"),
        ("a/parts/deep/e.xml", "<mujocoinclude><geom size='3'/></mujocoinclude>"),
        ("a/parts/g.xml", "<mujoco model='x'>\n  <geom name='g'/></mujoco>"),
    ])
    .unwrap();
    let geom = &model.bodies[1].geoms[0];
    assert_eq!((geom.size()[0], geom.place.to_string().as_str()), (3.0, "a/parts/g.xml:2:3"));
}

#[test]
fn the_folder_of_the_main_file_comes_first() {
    let files = [
        ("m.xml", "<mujoco><include file='p/i.xml'/></mujoco>"),
        ("p/i.xml", "<mujocoinclude><include file='g.xml'/></mujocoinclude>"),
        ("g.xml", "<mujocoinclude><worldbody><geom name='main'/></worldbody></mujocoinclude>"),
        ("p/g.xml", "<mujocoinclude><worldbody><geom name='other'/></worldbody></mujocoinclude>"),
    ];
    let name = |model: Mjcf| model.bodies[0].geoms[0].name.clone().unwrap();
    assert_eq!(name(read_files(&files).unwrap()), "main");
    assert_eq!(name(read_files(&[files[0], files[1], files[3]]).unwrap()), "other");
}

#[test]
fn files_that_cannot_be_had_are_told_with_their_element() {
    let message = |file: &str| {
        let main = format!("<mujoco>\n <include file='{file}'/></mujoco>");
        let own = "<mujocoinclude><include file='own.xml'/></mujocoinclude>";
        read_files(&[("m.xml", &main), ("own.xml", own), ("empty.xml", ""), ("robot.xml", "<robot/>")])
            .unwrap_err()
            .to_string()
    };
    let outside = "lies outside the folder of the model; give a larger root folder if it is meant";
    assert_eq!(message("no.xml"), "m.xml:2:11: <include> file: `no.xml` does not exist");
    assert_eq!(message("../x.xml"), format!("m.xml:2:11: <include> file: `../x.xml` {outside}"));
    assert_eq!(message("/x.xml"), format!("m.xml:2:11: <include> file: `/x.xml` {outside}"));
    let twice = "is included already; a file may be included once";
    assert_eq!(message("m.xml"), format!("m.xml:2:11: <include> file: `m.xml` {twice}"));
    assert_eq!(message("own.xml"), format!("own.xml:1:25: <include> file: `own.xml` {twice}"));
    assert_eq!(
        message("robot.xml"),
        "robot.xml:1:1: <robot>: the root of a file to include is `mujocoinclude` or `mujoco`"
    );
    assert_eq!(message("empty.xml"), "empty.xml:1:1: the document does not have a root node");
}

#[test]
fn a_model_cannot_attach_itself() {
    let error = read_files(&[
        (
            "a.xml",
            "<mujoco><asset><model name='b' file='b.xml'/></asset><worldbody><attach model='b' prefix='x'/></worldbody></mujoco>",
        ),
        ("b.xml", "<mujoco><asset><model name='a' file='a.xml'/></asset></mujoco>"),
    ]);
    let message = "b.xml:1:32: <model name=\"a\"> file: `a.xml` is included already; a file may be included once";
    assert_eq!(error.unwrap_err().to_string(), message);
}

#[test]
fn assets_name_files_and_do_not_open_them() {
    let model = read_files(&[(
        "a/m.xml",
        "<mujoco><compiler assetdir='all' texturedir='../t'/><asset><mesh file='sub/bone.stl'/><mesh name='x' file='/m/y.obj'/>\
         <texture name='s' fileup='up.png' filedown='../../../down.png'/></asset></mujoco>",
    )])
    .unwrap();
    let mesh = &model.meshes[0];
    assert_eq!((mesh.name.as_deref(), mesh.path.as_ref().unwrap().path.as_str()), (Some("bone"), "a/all/sub/bone.stl"));
    assert_eq!(mesh.path.as_ref().unwrap().below_root().unwrap(), "a/all/sub/bone.stl");
    assert_eq!(model.meshes[1].path.as_ref().unwrap().below_root(), Err(FileError::Outside));
    let [(up, up_file), (_, down)] = &model.textures[0].paths[..] else { panic!() };
    assert_eq!((*up, up_file.below_root().unwrap().as_str()), ("fileup", "t/up.png"));
    assert_eq!(down.below_root(), Err(FileError::Outside));
}

#[test]
fn a_stripped_path_is_a_name() {
    let model = read("<compiler strippath='true' meshdir='m'/><asset><mesh file='C:\\far\\away\\b.stl'/></asset>");
    assert_eq!(model.meshes[0].path.as_ref().unwrap().path, "m/b.stl");
}

#[test]
fn a_folder_is_not_left_by_links_either() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("inside");
    fs::create_dir(&inside).unwrap();
    fs::write(folder.path().join("secret.xml"), "<mujocoinclude><option timestep='1'/></mujocoinclude>").unwrap();
    let main = inside.join("m.xml");
    fs::write(&main, "<mujoco><include file='../secret.xml'/></mujoco>").unwrap();
    let error = myo_mjcf::read(&main).unwrap_err().to_string();
    assert!(error.starts_with("m.xml:1:18: <include> file: `../secret.xml` lies outside"), "{error}");
    assert_eq!(myo_mjcf::read_below(folder.path(), &main).unwrap().option.timestep(), 1.0);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../secret.xml", inside.join("link.xml")).unwrap();
        fs::write(&main, "<mujoco><include file='link.xml'/></mujoco>").unwrap();
        let error = myo_mjcf::read(&main).unwrap_err().to_string();
        assert!(error.starts_with("m.xml:1:18: <include> file: `link.xml` lies outside"), "{error}");
    }
}

#[test]
fn a_main_file_that_cannot_be_had_is_told() {
    let error = myo_mjcf::read(Path::new("no/such/model.xml")).unwrap_err();
    assert_eq!(error.to_string(), "no/such/model.xml: does not exist");
    let folder = tempfile::tempdir().unwrap();
    assert!(myo_mjcf::read_below(&folder.path().join("no"), folder.path()).is_err());
    fs::write(folder.path().join("m.xml"), [0xff, 0xfe]).unwrap();
    let error = myo_mjcf::read(&folder.path().join("m.xml")).unwrap_err().to_string();
    assert_eq!(error, "m.xml: is not text in UTF-8");
    assert!(Folder::new(&folder.path().join("m.xml")).is_ok_and(|folder| folder.relative(Path::new("/")).is_err()));
}
