//! The statements of the overlay description language, as a table.

use Part::{Choice, Literal, Name, Number, OptionalName, OptionalNumber, Point, Points};

/// Kinds of statements, by their keyword.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyword {
    Scenario,
    Site,
    Origin,
    GlobalRefPoint,
    Heading,
    MissionArea,
    LoadMap,
    Heightmap,
    Set,
    Scale,
    Obstacle,
    Object,
    Wall,
    Boundary,
    PassagePoint,
    /// Drawn for people; ignored by the planner.
    Annotation,
    ObsoleteStart,
}

/// The two halves of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Section {
    Information,
    Measures,
}

/// One part of a statement. Strings are the part's name in messages.
#[derive(Clone, Copy, Debug)]
pub(super) enum Part {
    /// A bare word or a quoted string.
    Name,
    /// A name that the language requires and the planner ignores.
    OptionalName(&'static str),
    /// One coordinate.
    Point,
    /// One or more coordinates. If `then` is set, an odd last number is that value.
    Points {
        then: Option<&'static str>,
    },
    Number(&'static str),
    OptionalNumber,
    Literal(&'static str),
    Choice(&'static [&'static str]),
}

/// Syntax of a statement.
#[derive(Debug)]
pub(super) struct Form {
    /// All spellings of its keyword.
    pub(super) spellings: &'static [&'static str],
    pub(super) keyword: Keyword,
    pub(super) section: Section,
    pub(super) parts: &'static [Part],
    /// The parts after the keyword, as shown in help.
    pub(super) usage: &'static str,
}

const fn information(
    spellings: &'static [&'static str],
    keyword: Keyword,
    parts: &'static [Part],
    usage: &'static str,
) -> Form {
    Form { spellings, keyword, section: Section::Information, parts, usage }
}

const fn measure(
    spellings: &'static [&'static str],
    keyword: Keyword,
    parts: &'static [Part],
    usage: &'static str,
) -> Form {
    Form { spellings, keyword, section: Section::Measures, parts, usage }
}

/// Mobility of an OBJECT; the first is an obstacle.
pub(super) const STYLES: &[&str] = &["FIXED", "MOVABLE", "CONTAINER"];

const LINE: &[Part] = &[Name, Points { then: None }];
const ROUND: &[Part] = &[Point, OptionalNumber];

/// Every statement.
pub(super) const FORMS: &[Form] = &[
    information(&["SCENARIO"], Keyword::Scenario, &[Name], "name"),
    information(&["SITE"], Keyword::Site, &[Name], "name"),
    information(&["ORIGIN"], Keyword::Origin, &[Point], "x y"),
    information(
        &["GLOBAL_REF_POINT"],
        Keyword::GlobalRefPoint,
        &[Number("latitude"), Number("longitude")],
        "latitude longitude",
    ),
    information(&["HEADING"], Keyword::Heading, &[Number("heading")], "degrees"),
    information(
        &["MISSION-AREA"],
        Keyword::MissionArea,
        &[Number("width"), Number("height")],
        "width height",
    ),
    information(&["LOAD-MAP"], Keyword::LoadMap, &[Name], "\"file\""),
    information(
        &["HEIGHTMAP"],
        Keyword::Heightmap,
        &[Name, Number("width"), Number("height"), Number("sea level"), Number("scale")],
        "\"file\" width height sea-level scale",
    ),
    information(&["SET"], Keyword::Set, &[Name, Number("percentage")], "ZOOM-FACTOR percentage"),
    information(&["SCALE"], Keyword::Scale, &[Number("scale")], "number"),
    measure(
        &["OBSTACLE"],
        Keyword::Obstacle,
        &[Point, Number("radius"), OptionalNumber],
        "x y radius [height]",
    ),
    measure(
        &["OBJECT"],
        Keyword::Object,
        &[Point, Number("diameter"), Choice(STYLES), OptionalName("colour")],
        "x y diameter FIXED|MOVABLE|CONTAINER colour",
    ),
    measure(
        &["WALL"],
        Keyword::Wall,
        &[Name, Points { then: Some("height") }],
        "name x y x y ... [height]",
    ),
    measure(&["BOUNDARY"], Keyword::Boundary, LINE, "name x y x y ..."),
    measure(&["PP"], Keyword::PassagePoint, &[Name, Point, OptionalNumber], "name x y [diameter]"),
    measure(
        &["GAP"],
        Keyword::Annotation,
        &[Name, Point, Point, OptionalNumber],
        "name x y x y [width]",
    ),
    measure(
        &["AA", "ATK", "BP", "OBJ"],
        Keyword::Annotation,
        &[Name, Points { then: Some("diameter") }],
        "name x y x y ... [diameter]",
    ),
    measure(
        &["AXIS"],
        Keyword::Annotation,
        &[Name, Points { then: Some("width") }],
        "name x y x y ... [width]",
    ),
    measure(&["LDLC", "LD/LC", "PL"], Keyword::Annotation, LINE, "name x y x y ..."),
    measure(&["ROOM", "DOOR"], Keyword::Annotation, LINE, "name x y x y ..."),
    measure(
        &["HALLWAY"],
        Keyword::Annotation,
        &[
            Name,
            Literal("CENTERLINE"),
            Points { then: None },
            Literal("WIDTH"),
            Number("width"),
            Literal("EXTENTS"),
            Points { then: None },
        ],
        "name CENTERLINE x y x y ... WIDTH width EXTENTS x y x y ...",
    ),
    measure(&["BASKET", "ATTRACTOR"], Keyword::Annotation, ROUND, "x y [diameter]"),
    measure(&["WAYPOINT-FILE"], Keyword::Annotation, &[Name], "\"file\""),
    measure(&["SP"], Keyword::ObsoleteStart, &[Name, Point], "name x y"),
];

/// The form with this keyword, in any letter case.
pub(super) fn form_of(word: &str) -> Option<&'static Form> {
    FORMS.iter().find(|form| form.spellings.iter().any(|s| s.eq_ignore_ascii_case(word)))
}

/// Whether a word occurs inside statements, so that it cannot begin one.
pub(super) fn is_inner_word(word: &str) -> bool {
    let literals = FORMS.iter().flat_map(|form| form.parts).filter_map(|part| match part {
        Literal(literal) => Some(literal),
        _ => None,
    });
    let mut inner = literals.chain(STYLES).chain(&["UTM", "LAT", "LON"]);
    inner.any(|inner| inner.eq_ignore_ascii_case(word))
}

/// The keyword most similar to a word, if any is.
pub(super) fn nearest_keyword(word: &str) -> Option<&'static str> {
    let word = word.to_ascii_uppercase();
    FORMS
        .iter()
        .flat_map(|form| form.spellings)
        .chain(&["CONTROL"])
        .map(|spelling| (strsim::damerau_levenshtein(&word, spelling), *spelling))
        .filter(|(distance, spelling)| distance * 3 <= spelling.len())
        .min()
        .map(|(_, spelling)| spelling)
}
