//! Files as other programs write them, and as editors, mail and copying change them.

use super::*;
use ::image::{DynamicImage, ImageFormat};
use std::io::Cursor;

fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    image.write_to(&mut Cursor::new(&mut bytes), format).unwrap();
    bytes
}

#[test]
fn what_is_not_opaque_is_unknown_in_every_kind_of_image() {
    // Black, white, a transparent pixel, and a translucent one.
    let pixels = [[0, 0, 0, 255], [255, 255, 255, 255], [255, 255, 255, 0], [255, 255, 255, 254]];
    let colours = ::image::RgbaImage::from_raw(4, 1, pixels.concat()).unwrap();
    let colours = DynamicImage::from(colours);
    for image in [
        colours.clone(),
        colours.to_luma_alpha8().into(),
        colours.to_luma_alpha16().into(),
        colours.to_rgba16().into(),
    ] {
        let png = encoded(&image, ImageFormat::Png);
        let got = check_with(&[("a.pgm", &png)], YAML);
        assert!(got.ends_with("  #.??\n"), "{:?}: {got}", image.color());
    }
    for image in [DynamicImage::from(colours.to_rgb8()), colours.to_luma16().into()] {
        for format in [ImageFormat::Png, ImageFormat::Pnm] {
            let got = check_with(&[("a.pgm", &encoded(&image, format))], YAML);
            assert!(got.ends_with("  #...\n"), "{:?}: {got}", image.color());
        }
    }
    let bmp = encoded(&colours.to_rgb8().into(), ImageFormat::Bmp);
    assert!(check_with(&[("a.pgm", &bmp)], YAML).ends_with("  #...\n"));
}

#[test]
fn a_pgm_holds_what_its_header_says() {
    let good = b"P5\n3 2\n255\n\x00\xcd\xff\xff\xfe\xff";
    let plain = check_with(&[("a.pgm", good)], YAML);
    assert_eq!(plain, check(YAML));
    for (bytes, reason) in [
        // After a program converted its line ends.
        (&b"P5\r\n3 2\r\n255\r\n\x00\xcd\xff\xff\xfe\xff"[..], "the line ends of Windows"),
        (b"P5\n3 2\n255\r\n\x00\xcd\xff\xff\xfe\xff", "the line ends of Windows"),
        (b"P5\n3 2\n255\n\x00\xcd\xff\xff\xfe\xff\xff\xff", "it holds 2 bytes more"),
        (b"P5\n3 2\n255\n\x00\xcd\xff\xff\xfe\xff\na", "it holds 2 bytes more"),
        (b"P5\r\n3 2\r\n255\r\n\x00\xcd\xff\xff\xfe\n", "the line ends of Windows"),
        (b"P5\n3 2\n255\n\x00\xcd\xff\xff\xfe", "it is cut off"),
        (b"P5\n3 2\n65535\n\x00\xcd\xff\xff\xfe\xff", "it is cut off"),
        (b"P5\n3 2\n100\n\x00\xcd\xff\xff\xfe\xff", "values above the largest"),
        (b"P2 3 2 255 0 205 255 255 254 255 9", "it holds 1 value more"),
        (b"P2 3 2 100 0 205 255 255 254 255", "values above the largest"),
        (b"P4 9 1 \x80\x00\x00", "it holds 1 byte more"),
        (b"P1 3 1 1 0 0 1", "it holds 1 value more"),
        (b"P6 1 1 255 \0\0\0\0", "it holds 1 byte more"),
    ] {
        let got = check_with(&[("a.pgm", bytes)], YAML);
        assert!(got.contains(reason) && got.ends_with("no map\n"), "{bytes:?}: {got}");
    }
    for (bytes, cells) in [
        (&b"P4 9 1 \x81\x00"[..], "#......#."),
        (b"P1 3 1 1 00", "#.."),
        (b"P5 # a comment\n2 1 # another\n100\n\x00\x64", "#."),
        (b"P2 3 1 255 0\n205 255\n\n", "#?."),
        // A line end after the pixels.
        (b"P5 2 1 100\n\x00\x64\n", "#."),
        (b"P5 2 1 255\n\x00\xff\r\n", "#."),
    ] {
        let got = check_with(&[("a.pgm", bytes)], YAML);
        assert!(got.ends_with(&format!("  {cells}\n")), "{bytes:?}: {got}");
    }
}

#[test]
fn the_yaml_may_hold_tabs_comments_and_other_line_ends() {
    let plain = check(YAML);
    for text in [
        YAML.replace(": ", ":\t"),
        YAML.replace(": ", " :\t\t"),
        YAML.replace('\n', "\r\n"),
        YAML.replace('\n', "\r"),
        YAML.replace('\n', " # what map_saver says\n"),
        format!("---\n# Straße\n{YAML}...\n"),
        YAML.replace("negate: 0", "negate: 0.0"),
        YAML.replace("[-1.0, 2, 0.0]", "\n  - -1.0\n  - 2.0 # y\n  - 0.0"),
    ] {
        assert!(recognises(&text), "{text}");
        assert_eq!(check(&text), plain, "{text}");
    }
}

#[test]
fn places_are_right_after_letters_of_several_bytes() {
    let got = check(&format!("# Übergrößenträger 東京\n{}", YAML.replace("0.5", "weit")));
    assert!(got.contains("[a.yaml:3:13]") && got.contains("2 │ image: a.pgm"), "{got}");
}

#[test]
fn a_yaw_beyond_a_turn_is_probably_degrees() {
    let got = check(&YAML.replace("2, 0.0", "2, 90"));
    assert!(got.contains("⚠ the yaw of `origin` is 90 rad"), "{got}");
    assert!(got.contains("write `origin: [-1, 2, 1.5708]`"), "{got}");
    for yaw in ["-nan", "nan", ".nan"] {
        let got = check(&YAML.replace("2, 0.0", &format!("2, {yaw}")));
        assert!(got.contains("⚠ the yaw of `origin` is not a number; 0 is assumed"), "{got}");
        assert!(got.ends_with("  #?.\n  ...\n"), "{got}");
    }
    for yaw in ["6.2832", "-3.14", "1.5708"] {
        let got = check(&YAML.replace("2, 0.0", &format!("2, {yaw}")));
        assert!(!got.contains('⚠'), "{got}");
    }
}

#[test]
fn a_threshold_that_frees_unknown_cells_is_reported() {
    let quarter = YAML.replace("0.196", "0.25");
    let without = b"P2 2 1 255 0 254";
    assert!(!check_with(&[("a.pgm", without)], &quarter).contains('⚠'));
    for text in [quarter.replace("negate: 0", "negate: 1"), format!("{quarter}mode: scale\n")] {
        assert!(!check(&text).contains("which map savers write"), "{text}");
    }
    assert!(check(&format!("{quarter}mode: trinary\n")).contains("⚠ 1 cells of grey 205"));
    // Without a threshold the default of ROS 1 applies.
    let silent = check(&YAML.replace("free_thresh: 0.196\n", ""));
    assert!(silent.ends_with("  #?.\n  ...\n"), "{silent}");
}

#[test]
fn an_image_is_found_where_it_was_copied_to() {
    let yaml = |name: &str| YAML.replace("a.pgm", name);
    let got = check(&yaml("/home/robot/maps/a.pgm"));
    assert!(got.contains("it lies beside the YAML file: write `image: a.pgm`"), "{got}");
    let got = check(&yaml("C:\\maps\\a.pgm"));
    assert!(got.contains("write `image: a.pgm`"), "{got}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("maps")).unwrap();
    std::fs::write(folder.path().join("maps/a.pgm"), GREYS).unwrap();
    for name in ["maps/a.pgm", "maps\\a.pgm", "./maps/../maps/a.pgm"] {
        let source = Arc::new(Source { name: "a.yaml".into(), text: yaml(name) });
        assert!(read(&folder.path().join("a.yaml"), &source).0.is_some(), "{name}");
    }
    let absolute = folder.path().join("maps/a.pgm");
    let source = Arc::new(Source { name: "a".into(), text: yaml(absolute.to_str().unwrap()) });
    assert!(read(Path::new("elsewhere/a.yaml"), &source).0.is_some());
}

#[test]
fn foreign_yaml_gives_one_error() {
    let got = check("amcl:\n  ros__parameters:\n    use_sim_time: true\nplanner_server: {}\n");
    assert_eq!(got.matches('×').count(), 1, "{got}");
    assert!(got.contains("does not describe a map") && got.contains("yaml_filename"), "{got}");
}

#[test]
fn endless_yaml_is_refused_before_it_is_parsed() {
    for text in [
        format!("image: {}", "[".repeat(200_000)),
        format!("image: a.pgm\nresolution: 1\n{}", "- ".repeat(100_000)),
        format!("image: a.pgm\norigin: {}1{}\n", "[".repeat(5_000), "]".repeat(5_000)),
        (0..60_000).map(|index| format!("key{index}: 1\n")).collect(),
        // A list that refers to itself repeatedly.
        (0..40).map(|n| format!("k{n}: &a{} [*a{n}, *a{n}]\n", n + 1)).collect::<String>()
            + "image: a.pgm\nresolution: 1\n",
    ] {
        let got = check(&text);
        assert!(got.contains('×') && got.len() < 4_000, "{got:.2000}");
    }
}

#[test]
fn an_image_rotated_beyond_the_grid_is_refused_before_allocation() {
    let mut wide = b"P4 16384 2000\n".to_vec();
    wide.resize(wide.len() + 16_384 * 2_000 / 8, 0);
    let got = check_with(&[("a.pgm", &wide)], &YAML.replace("2, 0.0", "2, 0.1"));
    assert!(got.contains("rotated by its yaw, the image of 16384 x 2000 pixels"), "{got}");
}
