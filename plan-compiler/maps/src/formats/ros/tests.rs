//! YAML and images in, cells or mistakes out.

use super::*;
use crate::formats::dump::outcome;
use insta::assert_snapshot;
use proptest::prelude::*;

mod others;

/// Reads a YAML text beside these files; removes the folder's path from messages.
fn check_with(files: &[(&str, &[u8])], text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let source = Arc::new(Source { name: "a.yaml".into(), text: text.into() });
    let outcome = outcome(&read(&folder.path().join("a.yaml"), &source));
    outcome.replace(&format!("{}/", folder.path().display()), "")
}

/// Black, 205 grey, white above three whites.
const GREYS: &[u8] = b"P2 # plain\n# more\n3 2\n255\n0 205 255\n255 254 255\n";
const YAML: &str = "\
image: a.pgm
resolution: 0.5
origin: [-1.0, 2, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
";

fn check(text: &str) -> String {
    check_with(&[("a.pgm", GREYS)], text)
}

#[test]
fn an_image_becomes_cells() {
    assert_snapshot!(check(YAML), @"
    extent -1,2 + 1.5,1
    resolution 0.5
    cells 3 x 2 of 0.5 from -1,2
      #?.
      ...
    ");
}

#[test]
fn values_may_be_quoted_and_spelled_as_map_server_takes_them() {
    let plain = check(YAML);
    for (by, spelled) in [
        ("resolution: 0.5", "resolution: \"0.5\""),
        ("origin: [-1.0, 2, 0.0]", "origin: ['-1.0', \"2\", 0]"),
        ("negate: 0", "negate: '0'"),
        ("negate: 0", "negate: no"),
        ("occupied_thresh: 0.65", "occupied_thresh: '.65'"),
    ] {
        assert_eq!(check(&YAML.replace(by, spelled)), plain, "{spelled}");
    }
    let light = check(&YAML.replace("negate: 0", "negate: 1"));
    for spelled in ["yes", "On", "'1'", "true"] {
        assert_eq!(check(&YAML.replace("negate: 0", &format!("negate: {spelled}"))), light);
    }
}

#[test]
fn every_kind_of_image_gives_the_same_cells() {
    let plain = check(YAML);
    let binary = b"P5\n# by map_saver\n3 2\n255\n\x00\xcd\xff\xff\xfe\xff";
    assert_eq!(check_with(&[("a.pgm", binary)], YAML), plain);
    let wide = b"P5 3 2 65535\n\x00\x00\xcd\xcd\xff\xff\xff\xff\xfe\xfe\xff\xff";
    assert_eq!(check_with(&[("a.pgm", wide)], YAML), plain);
    let colour = b"P6 3 2 255\n\0\0\0\xcd\xcd\xcd\xff\xff\xff\xff\xff\xff\xfe\xfe\xfe\xff\xff\xff";
    assert_eq!(check_with(&[("a.pgm", colour)], YAML), plain);
    let mut png = Vec::new();
    let pixels = vec![0, 205, 255, 255, 254, 255];
    let grey = ::image::GrayImage::from_raw(3, 2, pixels).unwrap();
    grey.write_to(&mut std::io::Cursor::new(&mut png), ::image::ImageFormat::Png).unwrap();
    assert_eq!(check_with(&[("a.pgm", &png)], YAML), plain);
}

#[test]
fn the_settings_decide() {
    let negated = check(&YAML.replace("negate: 0", "negate: true"));
    assert_snapshot!(negated, @"
    extent -1,2 + 1.5,1
    resolution 0.5
    cells 3 x 2 of 0.5 from -1,2
      .##
      ###
    ");
    // 205 is 0.196...: just unknown by map_saver's threshold, free by Nav2's.
    assert_snapshot!(check(&YAML.replace("0.196", "0.25")), @"
      ⚠ 1 cells of grey 205, which map savers write for unknown, are free because free_thresh is 0.25
       ╭─[a.yaml:6:14]
     5 │ occupied_thresh: 0.65
     6 │ free_thresh: 0.25
       ·              ──┬─
       ·                ╰── grey 205 has occupancy 0.196, which is below
       ╰────
      help: write `free_thresh: 0.196` if these cells are unknown

    extent -1,2 + 1.5,1
    resolution 0.5
    cells 3 x 2 of 0.5 from -1,2
      #..
      ...
    ");
    let raw = b"P2 5 1 255 0 19 65 100 255";
    let text = format!("{YAML}mode: raw\n");
    assert_snapshot!(check_with(&[("a.pgm", raw)], &text), @"
    extent -1,2 + 2.5,0.5
    resolution 0.5
    cells 5 x 1 of 0.5 from -1,2
      ..##?
    ");
    let mut png = Vec::new();
    let pixels = vec![0, 0, 0, 255, 0, 0, 0, 0, 255, 255, 255, 254, 250, 255, 255, 255];
    let colours = ::image::RgbaImage::from_raw(4, 1, pixels).unwrap();
    colours.write_to(&mut std::io::Cursor::new(&mut png), ::image::ImageFormat::Png).unwrap();
    assert_snapshot!(check_with(&[("a.pgm", &png)], &format!("{YAML}mode: scale\n")), @"
    extent -1,2 + 2,0.5
    resolution 0.5
    cells 4 x 1 of 0.5 from -1,2
      #??.
    ");
    for mode in ["trinary", "Trinary", "raw"] {
        // Transparent pixels are unknown in every mode; raw takes an opaque 255 as unknown too.
        let got = check_with(&[("a.pgm", &png)], &format!("{YAML}mode: {mode}\n"));
        let cells = if mode == "raw" { ".???" } else { "#??." };
        assert!(got.ends_with(&format!("  {cells}\n")), "{mode}: {got}");
    }
}

#[test]
fn a_yaw_rotates_the_cells() {
    assert_snapshot!(check(&YAML.replace("2, 0.0", "2, 1.5708")), @"
    extent -2,2 + 1,1.5
    resolution 0.5
    cells 2 x 3 of 0.5 from -2,2
      ..
      ?.
      #.
    ");
    assert_snapshot!(check(&YAML.replace("2, 0.0", "2, 0.5")), @"
    extent -1.479,2 + 2,2
    resolution 0.5
    boundary -1,2 0.316,2.719 -0.163,3.597 -1.479,2.878
    cells 4 x 4 of 0.5 from -1.479,2
      ....
      ##?.
      ##?.
      #...
    ");
}

#[test]
fn every_mistake_is_reported() {
    assert_snapshot!(check_with(
        &[("map.pgm", GREYS), ("b.png", b""), ("notes.txt", b"")],
        "image: mpa.pgm\nresolution: fine\norigin: [1, 2]\nnegate: 2\nocupied_thresh: 0.65\nfree_thresh: 7\nmode: tri\n",
    ), @"
      × there is no file mpa.pgm
       ╭─[a.yaml:1:8]
     1 │ image: mpa.pgm
       ·        ───┬───
       ·           ╰── this image
     2 │ resolution: fine
       ╰────
      help: the folder holds: b.png, map.pgm

      × `resolution` is not a length
       ╭─[a.yaml:2:13]
     1 │ image: mpa.pgm
     2 │ resolution: fine
       ·             ──┬─
       ·               ╰── expected metres per pixel
     3 │ origin: [1, 2]
       ╰────
      help: write the side of a pixel, for example `resolution: 0.05`

      × `origin` is not three numbers
       ╭─[a.yaml:3:9]
     2 │ resolution: fine
     3 │ origin: [1, 2]
       ·         ──┬──
       ·           ╰── expected x, y and yaw
     4 │ negate: 2
       ╰────
      help: write the south-west corner in metres and the yaw in radians: `origin: [-10, -10, 0]`

      × `negate` is neither 0 nor 1
       ╭─[a.yaml:4:9]
     3 │ origin: [1, 2]
     4 │ negate: 2
       ·         ┬
       ·         ╰── 0 or 1
     5 │ ocupied_thresh: 0.65
       ╰────
      help: write `negate: 0`, or 1 where white is occupied

      ⚠ `ocupied_thresh` is not a known key
       ╭─[a.yaml:5:1]
     4 │ negate: 2
     5 │ ocupied_thresh: 0.65
       · ───────┬──────
       ·        ╰── ignored
     6 │ free_thresh: 7
       ╰────
      help: did you mean `occupied_thresh`?

      × `free_thresh` is not a fraction
       ╭─[a.yaml:6:14]
     5 │ ocupied_thresh: 0.65
     6 │ free_thresh: 7
       ·              ┬
       ·              ╰── expected 0 to 1
     7 │ mode: tri
       ╰────
      help: map_saver writes occupied_thresh: 0.65 and free_thresh: 0.196

      × the mode is unknown
       ╭─[a.yaml:7:7]
     6 │ free_thresh: 7
     7 │ mode: tri
       ·       ───
       ╰────
      help: write `mode: trinary`, `scale` or `raw`, or leave the line out

      ⚠ `occupied_thresh` is missing; 0.65 is assumed
      help: add a line `occupied_thresh: 0.65`

    no map
    ");
    assert_snapshot!(check(&YAML.replace("0.196", "0.7").replace("resolution: 0.5", "resolution: -1")), @"
      × `resolution` is not a length
       ╭─[a.yaml:2:13]
     1 │ image: a.pgm
     2 │ resolution: -1
       ·             ─┬
       ·              ╰── expected metres per pixel
     3 │ origin: [-1.0, 2, 0.0]
       ╰────
      help: write the side of a pixel, for example `resolution: 0.05`

      × free_thresh 0.7 is not below occupied_thresh 0.65
       ╭─[a.yaml:6:14]
     5 │ occupied_thresh: 0.65
     6 │ free_thresh: 0.7
       ·              ─┬─
       ·               ╰── a pixel cannot be both
       ╰────
      help: if the two are swapped, swap them; map_saver writes occupied_thresh: 0.65 and free_thresh:
            0.196

    no map
    ");
    assert_snapshot!(check_with(&[], "image: a.pgm\n"), @"
      × there is no file a.pgm
       ╭─[a.yaml:1:8]
     1 │ image: a.pgm
       ·        ──┬──
       ·          ╰── this image
       ╰────
      help: there is no image in that folder; put it beside the YAML file

      × `resolution` is missing
      help: add a line, for example `resolution: 0.05`

      × `origin` is missing
      help: add a line, for example `origin: [0, 0, 0]`

      ⚠ `negate` is missing; 0 is assumed
      help: add a line `negate: 0`

      ⚠ `occupied_thresh` is missing; 0.65 is assumed
      help: add a line `occupied_thresh: 0.65`

      ⚠ `free_thresh` is missing; 0.196 is assumed
      help: add a line `free_thresh: 0.196`

    no map
    ");
    assert_snapshot!(check("- 1\n- 2\n"), @"
      × the file holds no `key: value` lines
       ╭─[a.yaml:1:1]
     1 │ - 1
       · ▲
     2 │ - 2
       ╰────
      help: a map's file has one `key: value` per line: image, resolution, origin, ...

    no map
    ");
    assert_snapshot!(check("image: [a\nresolution: 1\n"), @"
      × this is not YAML: illegal placement of ':' indicator
       ╭─[a.yaml:2:11]
     1 │ image: [a
     2 │ resolution: 1
       ·           ▲
       ·           ╰── here
       ╰────
      help: a map's file has one `key: value` per line: image, resolution, origin, ...

    no map
    ");
}

#[test]
fn images_that_cannot_be_read_are_explained() {
    let cut = "it is cut off";
    let mut png = Vec::new();
    let grey = ::image::GrayImage::from_fn(64, 64, |x, y| [(x * y) as u8].into());
    grey.write_to(&mut std::io::Cursor::new(&mut png), ::image::ImageFormat::Png).unwrap();
    for (bytes, reason) in [
        (&b"P5 3 2 255\n\0\0"[..], cut),
        (&png[..200], cut),
        (b"P5 99999 1 255\n", "it is too large"),
        (b"P5 60000 60000 255\n", "it is too large"),
        (b"GIF89a", "it is neither PGM, PNG nor BMP"),
        (b"P5 x", ""),
        (b"\x89PNG\r\n\x1a\n", ""),
    ] {
        let got = check_with(&[("a.pgm", bytes)], YAML);
        assert!(got.contains(&format!("cannot be read as an image: {reason}")), "{got}");
    }
}

#[test]
fn an_image_alone_is_not_a_map() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pgm");
    let message = |bytes: &[u8]| refuse_alone(&path, bytes).map(|problem| problem.help.unwrap());
    assert!(message(GREYS).unwrap().starts_with("name the YAML file that goes with it"));
    std::fs::write(folder.path().join("a.yaml"), YAML).unwrap();
    assert!(message(GREYS).unwrap().ends_with("a.yaml"));
    assert_eq!(message(b"PP a 1 2"), None);
}

proptest! {
    #[test]
    fn no_text_makes_it_panic(text in "(image|resolution|origin|mode|: |\\[|\\]|\n|[0-9.,-]|\\PC){0,40}") {
        recognises(&text);
        check(&text);
    }

    #[test]
    fn no_image_makes_it_panic(
        at in 0usize..40, byte: u8, header in "P[1-7][ \n][0-9]{1,3} [0-9]{1,3}[ \n][0-9]{1,6}\n", pixels: Vec<u8>,
    ) {
        let mut bytes = header.into_bytes();
        bytes.extend(pixels);
        if let Some(place) = bytes.get_mut(at) {
            *place = byte;
        }
        check_with(&[("a.pgm", &bytes)], YAML);
    }
}
