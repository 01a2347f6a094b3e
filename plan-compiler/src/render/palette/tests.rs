//! Colour vision, simulated.

use super::*;
use crate::render::cells::MAX_BANDS;
use math::scalar::wide;

/// Matrices from linear light to what people with usual vision, a protanope, a deuteranope and a
/// tritanope see (Machado, Oliveira and Fernandes 2009, severity 1).
const VISIONS: [(&str, [[f64; 3]; 3]); 4] = [
    ("usual", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    (
        "protanopia",
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ],
    ),
    (
        "deuteranopia",
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ],
    ),
    (
        "tritanopia",
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ],
    ),
];

fn linear(colour: [u8; 3]) -> [f64; 3] {
    colour.map(|channel| {
        let value = f64::from(channel) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { wide::pow((value + 0.055) / 1.055, 2.4) }
    })
}

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|row| (0..3).map(|column| matrix[row][column] * v[column]).sum())
}

/// CIE L*a*b* of linear sRGB under D65.
fn lab(light: [f64; 3]) -> [f64; 3] {
    const XYZ: [[f64; 3]; 3] = [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ];
    const WHITE: [f64; 3] = [0.95047, 1.0, 1.08883];
    let xyz = times(&XYZ, light.map(|channel| channel.clamp(0.0, 1.0)));
    let f = |axis: usize| {
        let t = xyz[axis] / WHITE[axis];
        if t > 216.0 / 24389.0 {
            wide::pow(t, 1.0 / 3.0)
        } else {
            (24389.0 / 27.0 * t + 16.0) / 116.0
        }
    };
    [116.0 * f(1) - 16.0, 500.0 * (f(0) - f(1)), 200.0 * (f(1) - f(2))]
}

/// The distance of CIEDE2000 (Sharma, Wu and Dalal 2005).
fn distance(one: [f64; 3], other: [f64; 3]) -> f64 {
    let seven = wide::pow(25.0, 7.0);
    let root = |chroma: f64| {
        let power = wide::pow(chroma, 7.0);
        wide::sqrt(power / (power + seven))
    };
    let mean_chroma = (wide::hypot(one[1], one[2]) + wide::hypot(other[1], other[2])) / 2.0;
    let stretch = 1.0 + 0.5 * (1.0 - root(mean_chroma));
    let polar = |[_, a, b]: [f64; 3]| {
        let hue = wide::atan2(b, a * stretch).to_degrees();
        (wide::hypot(a * stretch, b), if hue < 0.0 { hue + 360.0 } else { hue })
    };
    let ((c1, h1), (c2, h2)) = (polar(one), polar(other));
    let is_grey = c1 * c2 == 0.0;
    let turn = match h2 - h1 {
        _ if is_grey => 0.0,
        turn if turn > 180.0 => turn - 360.0,
        turn if turn < -180.0 => turn + 360.0,
        turn => turn,
    };
    let hue = match h1 + h2 {
        sum if is_grey => sum,
        sum if (h1 - h2).abs() <= 180.0 => sum / 2.0,
        sum if sum < 360.0 => (sum + 360.0) / 2.0,
        sum => (sum - 360.0) / 2.0,
    };
    let sine = |degrees: f64| wide::sin(degrees.to_radians());
    let cosine = |degrees: f64| wide::cos(degrees.to_radians());
    let (lightness, chroma) = ((one[0] + other[0]) / 2.0, (c1 + c2) / 2.0);
    let t =
        1.0 - 0.17 * cosine(hue - 30.0) + 0.24 * cosine(2.0 * hue) + 0.32 * cosine(3.0 * hue + 6.0)
            - 0.20 * cosine(4.0 * hue - 63.0);
    let from_50 = (lightness - 50.0) * (lightness - 50.0);
    let by_lightness = 1.0 + 0.015 * from_50 / wide::sqrt(20.0 + from_50);
    let (by_chroma, by_hue) = (1.0 + 0.045 * chroma, 1.0 + 0.015 * chroma * t);
    let bump = (hue - 275.0) / 25.0;
    let rotation = -2.0 * root(chroma) * sine(60.0 * wide::exp(-bump * bump));
    let dl = (other[0] - one[0]) / by_lightness;
    let dc = (c2 - c1) / by_chroma;
    let dh = 2.0 * wide::sqrt(c1 * c2) * sine(turn / 2.0) / by_hue;
    wide::sqrt(dl * dl + dc * dc + dh * dh + rotation * dc * dh)
}

/// The smallest distance between two colours over all kinds of vision.
fn least_distance(one: [u8; 3], other: [u8; 3]) -> (f64, &'static str) {
    let distances = VISIONS.iter().map(|(name, matrix)| {
        (distance(lab(times(matrix, linear(one))), lab(times(matrix, linear(other)))), *name)
    });
    distances.min_by(|a, b| a.0.total_cmp(&b.0)).expect("there are visions")
}

fn contrast(one: [u8; 3], other: [u8; 3]) -> f64 {
    let luminance = |colour| {
        let [red, green, blue] = linear(colour);
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    };
    let (one, other) = (luminance(one), luminance(other));
    (one.max(other) + 0.05) / (one.min(other) + 0.05)
}

/// Asserts that all colours can be distinguished.
fn apart(colours: &[(String, [u8; 3])], least: f64) {
    for (index, (name, colour)) in colours.iter().enumerate() {
        for (other_name, other) in &colours[..index] {
            let (found, vision) = least_distance(*colour, *other);
            assert!(found >= least, "{name} and {other_name}: {found:.1} under {vision}");
        }
    }
}

fn bands(bands: usize) -> Vec<(String, [u8; 3])> {
    (0..bands).map(|index| (format!("band {index} of {bands}"), band(index, bands))).collect()
}

fn named(colours: &[&str]) -> Vec<(String, [u8; 3])> {
    colours.iter().map(|colour| ((*colour).to_owned(), rgb(colour))).collect()
}

#[test]
fn the_distance_is_that_of_its_authors() {
    // Pairs 1, 7, 17 and 25 of their test data.
    for (one, other, expected) in [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
    ] {
        assert!((distance(one, other) - expected).abs() < 1e-4, "{}", distance(one, other));
    }
    let [l, a, b] = lab(linear([255, 0, 0]));
    assert!((l - 53.24).abs() < 0.01 && (a - 80.09).abs() < 0.02 && (b - 67.2).abs() < 0.02);
    assert!((contrast([0; 3], [255; 3]) - 21.0).abs() < 1e-9);
}

#[test]
fn red_and_green_of_old_would_fail() {
    let (found, vision) = least_distance(rgb("#c22f2f"), rgb("#5a6e1e"));
    assert!(found < 10.0, "{found} under {vision}");
}

#[test]
fn neighbouring_bands_of_cost_can_be_told_apart() {
    for count in 2..=MAX_BANDS {
        for pair in bands(count).windows(2) {
            apart(pair, 3.9);
        }
        // A band is never taken for the one after the next, in a legend that is not beside it.
        for triple in bands(count).windows(3) {
            apart(&[triple[0].clone(), triple[2].clone()], 7.0);
        }
    }
}

#[test]
fn cells_of_all_kinds_can_be_told_apart() {
    for other in named(&[BLOCKED, OBSTACLE]) {
        for band in bands(MAX_BANDS) {
            apart(&[other.clone(), band], 12.0);
        }
    }
    apart(&named(&[BLOCKED, OBSTACLE, PAPER]), 20.0);
    assert!(contrast(rgb(HATCH), rgb(PAPER)) >= 3.0);
    apart(&named(&[ATTENUATING, ZONE, OBSTACLE]), 15.0);
    apart(&named(&[BORDER, ADVICE, GOAL]), 15.0);
    apart(&named(&[UNMAPPED, OBSTACLE, BLOCKED, PAPER]), 15.0);
}

#[test]
fn routes_can_be_told_apart_and_from_their_casing() {
    let colours: Vec<&str> = ROUTES.into_iter().chain([NO_BEHAVIOUR_STYLE.0]).collect();
    apart(&named(&colours), 12.0);
    for colour in colours {
        assert!(contrast(rgb(colour), rgb(PAPER)) >= 3.0, "{colour}");
    }
    let routes: Vec<_> = (0..25).chain([crate::render::NO_BEHAVIOUR]).map(route).collect();
    for (index, one) in routes.iter().enumerate() {
        assert!(!routes[..index].contains(one), "{one:?} twice");
    }
}

#[test]
fn the_parts_of_a_graph_can_be_told_apart() {
    for pair in named(&SHADES).windows(2) {
        apart(pair, 4.0);
    }
    apart(&named(&[INK, FAINT, INTERVAL]), 12.0);
}

#[test]
fn text_and_arrows_stand_out_from_their_ground() {
    let of_graphs = [(FAINT, PANEL), (INTERVAL, PANEL)];
    let shades = SHADES.map(|shade| (INK, shade));
    let grounds = [(INK, PAPER), (FAINT, PAPER), (INK, GOAL)];
    for (text, ground) in grounds.into_iter().chain(of_graphs).chain(shades) {
        assert!(contrast(rgb(text), rgb(ground)) >= 4.5, "{text} on {ground}");
    }
    for (name, band) in bands(MAX_BANDS) {
        assert!(contrast(rgb(ADVICE), band) >= 3.0, "arrows on {name}");
    }
}
