//! XML in, mistakes as a user sees them out.

use super::*;

#[test]
fn mistakes_in_objects_are_all_reported() {
    let objects = "\
<node id=\"20\" lat=\"91\" lon=\"0\"/>
<node id=\"x\" lat=\"0\" lon=\"1,5\"/>
<node lat=\"0\"/>
<way id=\"1\"><nd/><nd ref=\"a\"/></way>
<relation id=\"2\">
  <member type=\"way\" role=\"outer\"/>
</relation>
<bounds minlat=\"2\" minlon=\"0\" maxlat=\"1\" maxlon=\"1\"/>
<bounds minlat=\"2\"/>";
    assert_snapshot!(check(objects), @r#"
      × node 20 is off the globe
        ╭─[a.osm:13:1]
     12 │   <node id="9" lat="0.0004" lon="0.0004"/>
     13 │ <node id="20" lat="91" lon="0"/>
        · ────────────────┬───────────────
        ·                 ╰── this node
     14 │ <node id="x" lat="0" lon="1,5"/>
        ╰────
      help: latitudes are -90 to 90 degrees, longitudes -180 to 180

      × the id of <node> is not a number
        ╭─[a.osm:14:11]
     13 │ <node id="20" lat="91" lon="0"/>
     14 │ <node id="x" lat="0" lon="1,5"/>
        ·           ┬
        ·           ╰── this
     15 │ <node lat="0"/>
        ╰────
      help: numbers are written as 12 or 51.0123456

      × the lon of <node> is not a number
        ╭─[a.osm:14:27]
     13 │ <node id="20" lat="91" lon="0"/>
     14 │ <node id="x" lat="0" lon="1,5"/>
        ·                           ─┬─
        ·                            ╰── this
     15 │ <node lat="0"/>
        ╰────
      help: numbers are written as 12 or 51.0123456

      × <node> has no id
        ╭─[a.osm:15:1]
     14 │ <node id="x" lat="0" lon="1,5"/>
     15 │ <node lat="0"/>
        · ───────┬───────
        ·        ╰── add id="..."
     16 │ <way id="1"><nd/><nd ref="a"/></way>
        ╰────
      help: save or fetch the file again; editors and servers always write it

      × <node> has no lon
        ╭─[a.osm:15:1]
     14 │ <node id="x" lat="0" lon="1,5"/>
     15 │ <node lat="0"/>
        · ───────┬───────
        ·        ╰── add lon="..."
     16 │ <way id="1"><nd/><nd ref="a"/></way>
        ╰────
      help: save or fetch the file again; editors and servers always write it

      × <nd> has no ref
        ╭─[a.osm:16:13]
     15 │ <node lat="0"/>
     16 │ <way id="1"><nd/><nd ref="a"/></way>
        ·             ──┬──
        ·               ╰── add ref="..."
     17 │ <relation id="2">
        ╰────
      help: save or fetch the file again; editors and servers always write it

      × the ref of <nd> is not a number
        ╭─[a.osm:16:27]
     15 │ <node lat="0"/>
     16 │ <way id="1"><nd/><nd ref="a"/></way>
        ·                           ┬
        ·                           ╰── this
     17 │ <relation id="2">
        ╰────
      help: numbers are written as 12 or 51.0123456

      × <member> has no ref
        ╭─[a.osm:18:3]
     17 │ <relation id="2">
     18 │   <member type="way" role="outer"/>
        ·   ────────────────┬────────────────
        ·                   ╰── add ref="..."
     19 │ </relation>
        ╰────
      help: save or fetch the file again; editors and servers always write it

      × the bounds are not a box on the globe
        ╭─[a.osm:20:1]
     19 │ </relation>
     20 │ <bounds minlat="2" minlon="0" maxlat="1" maxlon="1"/>
        · ──────────────────────────┬──────────────────────────
        ·                           ╰── these
     21 │ <bounds minlat="2"/>
        ╰────
      help: minlat and minlon are its south-west corner, in degrees

      × <bounds> has no minlon
        ╭─[a.osm:21:1]
     20 │ <bounds minlat="2" minlon="0" maxlat="1" maxlon="1"/>
     21 │ <bounds minlat="2"/>
        · ──────────┬─────────
        ·           ╰── add minlon="..."
     22 │ </osm>
        ╰────
      help: save or fetch the file again; editors and servers always write it

      × <bounds> has no maxlat
        ╭─[a.osm:21:1]
     20 │ <bounds minlat="2" minlon="0" maxlat="1" maxlon="1"/>
     21 │ <bounds minlat="2"/>
        · ──────────┬─────────
        ·           ╰── add maxlat="..."
     22 │ </osm>
        ╰────
      help: save or fetch the file again; editors and servers always write it

      × <bounds> has no maxlon
        ╭─[a.osm:21:1]
     20 │ <bounds minlat="2" minlon="0" maxlat="1" maxlon="1"/>
     21 │ <bounds minlat="2"/>
        · ──────────┬─────────
        ·           ╰── add maxlon="..."
     22 │ </osm>
        ╰────
      help: save or fetch the file again; editors and servers always write it

    extent -100.188,-49.758 + 200.375,99.517
    reference 0.00045 0.0009 at 0,0 heading 0
    "#);
}

#[test]
fn files_that_are_not_maps_are_refused() {
    let outcomes = [
        check_file("<osm version=\"0.6\">\n  <node id=\"1\" lat=\"0\" l\u{f6}n=\"0"),
        check_file("<osm>\n <node id=\"1\"></osm>"),
        check_file("<osmChange version=\"0.6\"><osm/></osmChange>"),
        check_file("<osm version=\"0.6\"/>"),
        check_file("<!DOCTYPE x [<!ENTITY a \"b\">]>\n<osm>&a;</osm>"),
        outcome(&read(
            &source(
                "<osm>\n<remark> runtime error: Query timed out </remark>\n\
             <node id=\"1\" lat=\"51\" lon=\"7\"/></osm>",
            ),
            &ReadOptions::default(),
        )),
    ];
    assert_snapshot!(outcomes.join("----\n"), @r#"
      × this is not XML: syntax error: attribute value not closed: `"` not found before end of input
       ╭─[a.osm:2:3]
     1 │ <osm version="0.6">
     2 │   <node id="1" lat="0" lön="0
       ·   ▲
       ·   ╰── here
       ╰────
      help: check whether the file was cut off, and save or fetch it again

    no map
    ----
      × <node> has no lat
       ╭─[a.osm:2:2]
     1 │ <osm>
     2 │  <node id="1"></osm>
       ·  ──────┬──────
       ·        ╰── add lat="..."
       ╰────
      help: save or fetch the file again; editors and servers always write it

      × <node> has no lon
       ╭─[a.osm:2:2]
     1 │ <osm>
     2 │  <node id="1"></osm>
       ·  ──────┬──────
       ·        ╰── add lon="..."
       ╰────
      help: save or fetch the file again; editors and servers always write it

      × this is not XML: ill-formed document: expected `</node>`, but `</osm>` was found
       ╭─[a.osm:2:15]
     1 │ <osm>
     2 │  <node id="1"></osm>
       ·               ▲
       ·               ╰── here
       ╰────
      help: check whether the file was cut off, and save or fetch it again

    no map
    ----
      × the file is a list of changes (.osc), not a map
       ╭─[a.osm:1:1]
     1 │ <osmChange version="0.6"><osm/></osmChange>
       · ────────────┬────────────
       ·             ╰── not <osm>
       ╰────
      help: apply it to the extract that it changes: `osmium apply-changes old.osm changes.osc -o
            new.osm`

    no map
    ----
      × the file has no coordinates and no bounds
      help: check that this is the file you mean

    no map
    ----
      × the file has no coordinates and no bounds
      help: check that this is the file you mean

    no map
    ----
      ⚠ the server remarks: runtime error: Query timed out
       ╭─[a.osm:2:1]
     1 │ <osm>
     2 │ <remark> runtime error: Query timed out </remark>
       · ────┬───
       ·     ╰── the file may be incomplete
     3 │ <node id="1" lat="51" lon="7"/></osm>
       ╰────
      help: fetch it again, or a smaller part

      ☞ the map is 20 m x 20 m, 10 m around its contents; 0,0 is its centre, latitude 51, longitude 7;
      │ obstacles: 0, areas that weaken radio: 0, zones: 0, named points: 0, not used: 0
      help: 0,0 depends on the file: `origin = [51, 7]` in the mission file or --origin 51,7 keeps it
            in place when the map changes

    extent -10,-10 + 20,20
    reference 51 7 at 0,0 heading 0
    "#);
}
