"""Every code a finding can have: what it checks, why it matters on the machine, what to do.

One table, so that ``wedmcam explain CODE`` and the documentation say the same. A code is a slug
that never changes its meaning.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Code:
    """What one code means.

    Attributes:
        what: what was found, in one line.
        why: what it would do on the machine.
        cure: what the user can do.
    """

    what: str
    why: str
    cure: str


CODES: dict[str, Code] = {
    # --- reading a drawing -----------------------------------------------------------------
    "not-dxf": Code(
        "The file is no DXF drawing.",
        "There is nothing to cut.",
        "Export the drawing as DXF, R12 or later; a DWG or a picture has to be converted first.",
    ),
    "damaged-drawing": Code(
        "The DXF file breaks its own rules, at the line named if it is known.",
        "A reader that guesses on would lose geometry or move it.",
        "Open the drawing in a CAD program, let it repair it, and export it again.",
    ),
    "merge-conflict": Code(
        "The file holds the markers of a version control conflict.",
        "Two drawings are mixed in it; neither of them is meant.",
        "Resolve the conflict, or export the drawing again.",
    ),
    "repaired-drawing": Code(
        "The file was put right in memory before reading: a version, subclass markers or handles "
        "were missing or wrong, or a part of it that is not cut is damaged and was left out.",
        "Without a version, polylines would lose their layer and their closed flag; without their "
        "markers, their vertices.",
        "Nothing has to be done; exporting the drawing again as R2000 or later is cleaner.",
    ),
    "no-units": Code(
        "The drawing does not say what one drawing unit is.",
        "A part in the wrong unit is 25.4 times too large or too small.",
        "Give --units mm, --units inch or --units um.",
    ),
    "units-overridden": Code(
        "--units differs from the unit that the drawing states.",
        "The drawing's own statement is ignored; the size of the part depends on it.",
        "Check the size that the message gives.",
    ),
    "unlikely-units": Code(
        "The part has an unlikely size in the unit it was read in, and a likely one in another.",
        "Many exporters write inch or metre into every drawing.",
        "Check the size, and give --units if the other one is right.",
    ),
    "units-contradict": Code(
        "$INSUNITS and $MEASUREMENT of the drawing contradict each other.",
        "One of them is wrong; the size of the part follows $INSUNITS.",
        "Check the size that `inspect` shows, and give --units to settle it.",
    ),
    "empty-drawing": Code(
        "There is nothing in the drawing that could be cut.",
        "An empty program would run without a word.",
        "Check layers and filters; geometry has to be in model space.",
    ),
    "not-cut": Code(
        "Entities that are no lines, arcs or polylines were left out.",
        "Text and dimensions are no contours, nor are hatches whose boundary is drawn; what is "
        "meant to be cut must be geometry.",
        "Nothing, or explode the entities into lines and arcs.",
    ),
    "drawing-frame": Code(
        "A rectangle lies round everything, and what lies in it has holes of its own, or is a "
        "title block.",
        "If it is the frame of the drawing, it is cut as the outer contour and the parts in it as "
        "holes: each part becomes a loose slug on the wrong side of the wire.",
        "Leave the frame out with --ignore-layer, or take the part with --layer; nothing, if it is "
        "a plate with parts nested in its windows.",
    ),
    "deep-nesting": Code(
        "A contour lies in a hole (three deep, or deeper).",
        "What is kept changes with every contour around: an island in a hole is a part of its own "
        "and comes loose; reference lines drawn in a hole become islands.",
        "Leave out with --ignore-layer what is not to be cut, or take the part with --layer; "
        "nothing, if parts are nested in the windows of others.",
    ),
    "hidden-not-cut": Code(
        "Entities that the drawing does not show were left out: layer off or frozen, invisible, "
        "or on DEFPOINTS.",
        "What is not seen in the drawing is not meant to be cut.",
        "Switch the layer on if it is.",
    ),
    "layer-left-out": Code(
        "Entities on layers that --layer and --ignore-layer leave out.",
        "They are not cut, as asked.",
        "Nothing.",
    ),
    "look-left-out": Code(
        "Entities of line types or colours that --linetype, --colour and their --ignore- leave "
        "out.",
        "They are not cut, as asked. BYLAYER is the layer's, BYBLOCK that of the INSERT.",
        "Nothing.",
    ),
    "filter-unmatched": Code(
        "A filter (--layer, --type, --linetype, --colour, or one of their --ignore-) that matches "
        "nothing in the drawing.",
        "A misspelt name leaves nothing out, and what was not meant would be cut.",
        "Correct the name; `wedmcam inspect` lists layers and types.",
    ),
    "type-left-out": Code(
        "Entities of types that --type and --ignore-type leave out.",
        "They are not cut, as asked.",
        "Nothing.",
    ),
    "unsupported-entity": Code(
        "An entity that could be a contour and that is not read: a curve or a body, a type that is "
        "not known, or a fill, a wide line or a face whose boundary no line draws.",
        "Leaving it out would cut another part: holes without their outline are loose discs.",
        "Convert it into lines, arcs or polylines. If it bounds nothing, leave it out with "
        "--ignore-layer or --ignore-type.",
    ),
    "tilted": Code(
        "An entity does not lie in a plane parallel to the drawing's.",
        "Seen from above an arc is an ellipse there.",
        "Lay the entity flat.",
    ),
    "not-flat": Code(
        "A line or polyline whose height changes along it.",
        "Its length seen from above is not its length.",
        "Lay the entity flat.",
    ),
    "taper": Code(
        "Geometry lies at different heights: a taper, or the edges of a body.",
        "Cut with a straight wire, seen from above, both outlines would be cut on top of each "
        "other.",
        "Lay it flat, or take the layer of one plane with --layer.",
    ),
    "bad-bulge": Code(
        "A polyline arc so bulged that it is a full circle but for nothing.",
        "Its radius and centre follow from rounding errors.",
        "Draw the circle as a circle.",
    ),
    "bad-number": Code(
        "A coordinate, radius or angle that is no finite number, or beyond 1000 km.",
        "Nothing can be cut there.",
        "Redraw or delete the entity named.",
    ),
    "missing-block": Code(
        "An INSERT of a block that the drawing does not hold.",
        "What it stands for would not be cut.",
        "Bind external references before exporting, or delete the INSERT.",
    ),
    "block-cycle": Code(
        "A block that inserts itself.",
        "It would never end.",
        "Delete the inner INSERT.",
    ),
    "approximated": Code(
        "Splines and ellipses became arcs that are tangent to each other.",
        "Wire machines know lines and circles only. How far the arcs are from the curves at most "
        "is measured, and stands in the certificate.",
        "Nothing; --tolerance sets how near they must be.",
    ),
    "spline-circle": Code(
        "A circle that was exported as splines was recognised: it is within 0.001 mm of one.",
        "Cut as a circle it needs fewer blocks, and is rounder than the export.",
        "Nothing.",
    ),
    "flat-ellipse": Code(
        "An ellipse with no width: it runs along a line and back.",
        "The wire would cut the same line twice.",
        "Draw a LINE, if that is meant.",
    ),
    "coarse-spline": Code(
        "A spline that arcs cannot follow within the tolerance.",
        "The part would not be as drawn.",
        "Look for loops, cusps and folds in it, or allow a larger --tolerance.",
    ),
    "fit-points": Code(
        "A spline for which the file holds only points that it passes through.",
        "How it runs between them is for each program to choose; it may differ from what is shown.",
        "Save the drawing with control points.",
    ),
    "open-spline": Code(
        "A spline that is marked as closed and whose ends do not meet.",
        "Closing it by a guess would add to the part.",
        "Close it in the CAD program.",
    ),
    "clipped-block": Code(
        "An INSERT with a clipping boundary.",
        "The boundary is not applied: parts that the drawing hides would be cut.",
        "Explode and trim the block.",
    ),
    "too-large": Code(
        "The drawing is larger than any part: in lines, segments, contours, or nesting.",
        "Arrays of arrays grow beyond any part, mostly by a wrong count; so do exported hatchings.",
        "Check the row and column counts of the INSERT named; export the outlines alone.",
    ),
    "full-arc": Code(
        "An ARC whose start and end angle are equal: taken as a full circle.",
        "It could also be meant as nothing.",
        "Draw a CIRCLE.",
    ),
    "stated-twice": Code(
        "A value that an entity or the header has once is there twice, or a section is.",
        "Readers take the first or the last; which of two radii or units is meant is not known. "
        "A note where both are the same.",
        "Export the drawing again, or remove one of them at the line named.",
    ),
    "not-stated": Code(
        "An entity lacks a value that it cannot be without: a circle its radius, a line its end.",
        "Readers take a default, such as a radius of 1; what would be cut was never drawn.",
        "Export the drawing again, or write the group at the line named.",
    ),
    "stated-count": Code(
        "An entity states another number of vertices, knots or points than it has.",
        "A part of it was lost, or another entity was mixed in; CAD programs refuse such a file.",
        "Export the drawing again, or correct the count at the line named.",
    ),
    "block-twice": Code(
        "A block is defined twice, or two names differ only in case, which makes no difference.",
        "CAD programs refuse the file or take either of them; both would be cut at every INSERT.",
        "Rename or remove one of them. Where nothing of the block is cut this is a warning.",
    ),
    "misplaced-group": Code(
        "A bulge of a polyline stands before its first vertex.",
        "It belongs to no vertex and is not used; what is meant may be an arc.",
        "Draw the polyline again, or move the line to its vertex.",
    ),
    "behind-end": Code(
        "There are data behind the end mark (EOF) of a drawing.",
        "They are not read; a second drawing joined to the first would be missing (a warning).",
        "Save the second drawing as a file of its own, or remove what follows the mark.",
    ),
    "insert-count": Code(
        "An INSERT with a negative number of columns or rows.",
        "How often to cut the block is not known. A number of 0 is read as 1.",
        "Insert the block as often as it is meant, or explode it.",
    ),
    "scale-zero": Code(
        "An INSERT that scales a block by 0 in x or y.",
        "Nothing is left of the block; a contour that is meant would be missing.",
        "Give the INSERT the scale that is meant, or delete it.",
    ),
    "negative-radius": Code(
        "A CIRCLE or an ARC with a negative radius.",
        "It is read as positive; CAD programs refuse it.",
        "Check the size, and on which side an arc lies.",
    ),
    "rounded-turn": Code(
        "An ARC or ELLIPSE a full turn but for the rounding of its angles: 12.345678 to "
        "372.345679, 0 to 6.28319.",
        "By the letter it would be an arc of no length; it is taken as a full circle.",
        "Nothing; a CIRCLE is clearer.",
    ),
    "no-arc": Code(
        "An ARC or ELLIPSE whose end angle is a hair over its start angle.",
        "It has no length and is not cut; if a full circle was meant, that is missing.",
        "Delete it, or draw a CIRCLE.",
    ),
    "over-turn": Code(
        "An ARC or ELLIPSE of more than a full turn, and by more than a hair.",
        "The full turns are left out, as in CAD programs: 0 to 365 degrees is an arc of 5.",
        "Check it in the picture; draw a CIRCLE if one is meant.",
    ),
    "polyline-width": Code(
        "A polyline with a width: its centre line is taken.",
        "The wire follows a line without width.",
        "Nothing, if the centre line is the contour.",
    ),
    "start-layer": Code(
        "Something on layer START that is no thread point.",
        "Layer START holds thread points (POINT, or small circles) and is never cut.",
        "Move the entity to another layer.",
    ),
    # --- contours --------------------------------------------------------------------------
    "zero-length": Code(
        "Pieces of drawing without length were dropped.",
        "They have no direction and cannot be cut.",
        "Nothing.",
    ),
    "duplicate": Code(
        "Segments that are drawn twice; one of each was left out.",
        "They would be cut twice, or make every corner a branch.",
        "Nothing, or delete the copies.",
    ),
    "join": Code(
        "Ends of segments that nearly met were joined.",
        "The contour moves there by half the gap.",
        "Nothing, if the gaps are as small as the drawing is inaccurate; else a smaller --join.",
    ),
    "join-moves-arc": Code(
        "Closing a gap at the end of an arc would move the whole arc.",
        "An almost full arc turns about the gap; its far side would move by much more.",
        "Draw the arc to its end, or lower --join.",
    ),
    "branch": Code(
        "More than two segments meet, and there is no one way to go on.",
        "A wire follows one path; which one is not for the compiler to guess.",
        "Remove construction lines, or put them on a layer of their own.",
    ),
    "overlap": Code(
        "Two segments run on top of each other for a part of their length.",
        "The part in common would be cut twice, and the contours do not close.",
        "Trim one of them.",
    ),
    "self-crossing": Code(
        "A contour crosses itself.",
        "It has no inside, so no side for the wire.",
        "Redraw it at the place named.",
    ),
    "crossing-contours": Code(
        "Two contours cross.",
        "What is inside the one and outside the other is both kept and removed.",
        "Trim them to one outline, or leave one out by its layer.",
    ),
    "contours-touch": Code(
        "Contours touch and do not cross.",
        "The material between them has no width at that place.",
        "Check that it is meant.",
    ),
    "drawn-twice": Code(
        "Two contours run beside each other, some um apart, for most of their length.",
        "Mostly an outline was traced, or exported twice. Where the two do not cross, the inner "
        "one is taken for a hole, and the part is cut into a frame as thin as that.",
        "Remove one of the two. With a wall below 4 um, or where they cross, it is an error; else "
        "a warning.",
    ),
    "thin-wall": Code(
        "Kept material between two contours, or two stretches of one, is too thin to be left.",
        "Below --thin-wall (0.05 mm) a wall, fin or neck seldom stands: a warning. Between two "
        "contours the path is proven within 2 um on either side, so a wall below 4 um is none: an "
        "error. Tips are not meant, however acute, sharp or cut off by a chamfer or a fillet.",
        "Draw the wall thicker, or remove the contour that is not meant; where it is meant, lower "
        "--thin-wall (0 for no warnings).",
    ),
    "speck": Code(
        "A closed contour that is smaller than anything a wire cuts.",
        "It would get a thread point and a cut of its own. A hole below 0.05 mm is too small for "
        "the finest wires; kept material is lost when it is smaller than the cut round it, twice "
        "the offset wide.",
        "Delete it, if it is not meant.",
    ),
    "open-contour": Code(
        "A contour that does not close.",
        "A part cannot be kept inside or outside of an open line.",
        "Close the gap in the drawing, raise --join, or cut it with --side left, right or on.",
    ),
    # --- part programs (.wed) ---------------------------------------------------------------
    "wed-syntax": Code(
        "A statement or a block of a part program, or a --transform, that cannot be read.",
        "Nothing is guessed: another word would make another part.",
        "Write it as the message says; docs/language.md has every form.",
    ),
    "wed-kind": Code(
        "A number stands where a point or a figure is needed, or the reverse.",
        "What it would mean is not known.",
        "Points are (x, y); figures are named by contour, or by let with a pipeline.",
    ),
    "wed-value": Code(
        "A value of a part program or of --transform is out of range, or no number at all.",
        "A root of a negative number or a thousand turns is a typing error.",
        "Give what the message asks for.",
    ),
    "wed-contour": Code(
        "A block of a contour that cannot be drawn from its clauses.",
        "An arc whose radius differs at its ends, or a fillet that does not fit, has no one path.",
        "Correct the dimension; the message has the numbers.",
    ),
    "unknown-name": Code(
        "A name that nothing has been given.",
        "A misspelt dimension would be another one.",
        "Take the name that is proposed, or give it with let before its use.",
    ),
    "name-taken": Code(
        "A name is given twice, or is a word of the language.",
        "Which of the two is meant would depend on the place.",
        "Take another name.",
    ),
    "no-cut": Code(
        "A part program that cuts nothing.",
        "An empty program would look like success.",
        "Add a line such as: cut NAME outside offset 0.1",
    ),
    "no-cut-offset": Code(
        "A cut names a side and no offset.",
        "The part would be too small or too large by half the kerf.",
        "Add offset LENGTH to the cut, or give --offset for all cuts that say none.",
    ),
    "wed-option": Code(
        "An option was given with a part program that says the same itself, or is for drawings; or "
        "two clauses of a cut exclude each other.",
        "It has no effect: whoever gave it would expect another program. Defaults of a shop "
        "(wedmcam.toml) are for every part and are passed over in silence.",
        "Leave it out, or change the part program.",
    ),
    "idle-option": Code(
        "An option was given that has no effect on this drawing.",
        "Whoever gave it would expect another program: a length of leads where every contour has "
        "its thread point, a pause on an open contour, the form of corners without an offset.",
        "Leave it out, or give what it goes with. Defaults of a shop (wedmcam.toml) are not told.",
    ),
    # --- figure transforms -----------------------------------------------------------------
    "figure-join": Code(
        "Open chains of a figure and its copies met and became one chain.",
        "The wire runs through them without a break; gaps under a micron are closed.",
        "Nothing; a large closing defect means angles or lengths that do not add up.",
    ),
    "figure-branch": Code(
        "More than two ends of chains meet at one place after a transform.",
        "It is open how the wire goes on there, so nothing is joined.",
        "Draw the figure so that each end meets one other end.",
    ),
    "reverse-closed": Code(
        "The transform `reverse` was applied to closed contours of a drawing.",
        "They are cut counter-clockwise whatever way they were drawn: it changes nothing.",
        "Use --reverse to cut clockwise.",
    ),
    "image-split": Code(
        "Arcs of an image of a program were written as several blocks.",
        "The path is the same; at their joints the controller goes on without a stop.",
        "Nothing is needed.",
    ),
    "transform-idle": Code(
        "A transform of a program changes none of its numbers.",
        "Blocks state no place: the whole program is moved by threading the wire elsewhere.",
        "Thread the wire where it is said; or ask for copies.",
    ),
    "pause-reversed": Code(
        "A pause before the end of a contour, in an image that is run in reverse.",
        "It comes behind the start there, and the machine does not stop before the piece is loose.",
        "Hold the piece in the image by hand, or transform the drawing and compile it.",
    ),
    "transform-differs": Code(
        "A program made of images does not step the vertices of the exact transform within 1 um.",
        "It would cut another part; it is not written.",
        "Convert to .zd or .3b: outlines with a gap can miss a vertex by a um more. Or transform "
        "the drawing, or the part program.",
    ),
    # --- wire path: compensation, leads, order ---------------------------------------------
    "no-offset": Code(
        "no offset was given, so the wire's centre runs on the drawn line",
        "the part gets smaller, and holes larger, by half the kerf on every side",
        "give --offset (or --wire and --gap), or say --side on if it is meant",
    ),
    "no-such-layer": Code(
        "a side or an offset was asked for of a layer that holds nothing to cut",
        "the contours that were meant are cut on the side of all others: a scrapped part",
        "name the layer as the drawing does; wedmcam inspect lists them",
    ),
    "behind-the-line": Code(
        "the clearance is at least wire / 2 + gap, so the wire runs on the drawn line or behind it",
        "that is right for a clearance so wide, and a surprise where it is a typing error",
        "check --clearance, --wire and --gap: offset = wire / 2 + gap - clearance",
    ),
    "clearance-untaken": Code(
        "A clearance was asked for, and no contour is cut as the one that takes it.",
        "everything is cut without it: punch and die would not go together",
        "say who takes it (--clearance-on), or which layer is it (--layer-side NAME=die)",
    ),
    "two-plates": Code(
        "contours of punches lie in the openings of their dies, and one program cuts both",
        "they cannot come out of one plate: the opening takes the material of the punch",
        "change the plate at the pause before the punches, or compile each layer alone (--layer)",
    ),
    "closed-left-right": Code(
        "a closed contour was asked to be cut on its left or right",
        "left of a closed contour is inside or outside, depending on how it was drawn",
        "say --side part or --side die; in a part program inside or outside",
    ),
    "nothing-to-cut": Code(
        "the offset leaves no path to cut",
        "a program without a cut would look like success",
        "a smaller offset, or another drawing",
    ),
    "interference": Code(
        "the wire does not fit: an inside radius, neck, slot or contour too small for the offset",
        "what the wire cannot reach stays uncut, and the part is not as drawn",
        "a thinner wire, a larger radius, or --on-interference trim to cut what can be reached",
    ),
    "inner-corners": Code(
        "sharp inner corners cannot be cut sharp: they keep the radius of the wire",
        "a punch with sharp corners does not fit into a die cut so. A chamfer, or a few facets, "
        "that the wire does not reach belong to their corner: less stays there than in the sharp "
        "one. "
        "What is drawn as an arc is a radius that is meant (interference), and so is a curve in "
        "lines of small turns; walls within 30 degrees of parallel are those of a slot",
        "--corner with at least the offset rounds the corners of both",
    ),
    "thread-point-unused": Code(
        "a thread point serves no contour",
        "a start hole that is not used was drilled for something else than is cut",
        "put it on the scrap side of its contour, or remove it",
    ),
    "thread-point-twice": Code(
        "two thread points serve one contour",
        "the wire can be threaded at one only",
        "remove one of them",
    ),
    "lead-hits": Code(
        "a lead meets its own path or another cut on its way",
        "the lead would cut into kept material, or into a piece that is already loose",
        "move the thread point, or give one",
    ),
    "lead-along-wall": Code(
        "a lead can only lie along a wall of its own corner",
        "its kerf, and the start hole, would damage the finished wall",
        "move 'enter' out of the corner, or give a thread point",
    ),
    "stop-too-short": Code(
        "the place of --stop is the step on which the cut ends, or that of its thread point",
        "the machine would pause after the cut, or not at all",
        "a longer --stop, or none",
    ),
    "overcut-too-short": Code(
        "--overcut ends on the step on which the contour closes",
        "there would be none",
        "a longer --overcut, or none",
    ),
    "stop-too-long": Code(
        "--stop is longer than the path",
        "the machine would pause before it begins",
        "a shorter --stop",
    ),
    "overcut-too-long": Code(
        "--overcut is longer than the path",
        "the contour would be cut twice",
        "a shorter --overcut",
    ),
    "corner-too-large": Code(
        "--corner does not fit between the neighbours of a corner",
        "the rounding would cut away a segment",
        "a smaller --corner",
    ),
    "arcs-not-met": Code(
        "with --corners paper, the offset arcs of a corner between arcs do not meet beside it",
        "the controller would have no path there, or one far from the corner",
        "--corners outer, or an arc drawn on the corner",
    ),
    "acute-corner": Code(
        "--corners paper on a corner below 60 degrees, with the offset as the radius of its arc",
        "punch and die have different offsets: with a radius of its own each has another corner, "
        "and the clearance between them is not what was meant",
        "--corner with one radius for both, no smaller than the larger of their offsets",
    ),
    "transition-arcs": Code(
        "how many corners of the outline have an arc, and which (--corners paper)",
        "punch and die fit each other only where both were cut with the same arcs",
        "Nothing is needed; the other of the two takes the same --corner.",
    ),
    "offset-unresolved": Code(
        "the crossings of the shifted segments did not form closed paths",
        "a path that is not proven closed could leave a contour uncut or cut into the part",
        "report the drawing; another offset, or a drawing without near-coincident lines, may help",
    ),
    # --- lowering --------------------------------------------------------------------------
    "blocks-split": Code(
        "arcs were split so that the stepped path stays within its budget of 2 um",
        "nothing: the program has some blocks more",
        "nothing to do",
    ),
    "specks-dropped": Code(
        "segments begin and end on the same micron and have no block of their own",
        "nothing: the path passes within a micron of them",
        "nothing to do; a cleaner drawing has fewer",
    ),
    "radius-over-limit": Code(
        "an arc's radius does not fit the format and is cut as chords",
        "the arc is cut within the stated sagitta, in more blocks",
        "choose a format that holds the radius (the compact format holds 10 m)",
    ),
    "move-too-long": Code(
        "a move between two thread points does not fit one block",
        "several lines between two D would be cut, not moved",
        "another --order, where one leads from contour to contour in shorter moves; a profile that "
        "moves with G00 (iso-mm); or a program for each group of contours (--cuts)",
    ),
    "cannot-lower": Code(
        "no stepped path within the budget of deviation was found",
        "nothing is written: it would not be the path that was proven",
        "report the drawing",
    ),
    # --- formats and profiles --------------------------------------------------------------
    "profile-syntax": Code(
        "A profile is not TOML.",
        "Nothing of it can be used.",
        "Mend the line that is named.",
    ),
    "profile-key": Code(
        "A profile has a key that is not read.",
        "A misspelt limit would be no limit.",
        "Correct or remove the key; `wedmcam profile show` prints a complete profile.",
    ),
    "profile-value": Code(
        "A value in a profile has the wrong type or is out of range.",
        "The program would not fit the controller.",
        "Give what the message asks for.",
    ),
    "profile-missing": Code(
        "A key that every profile must have is missing.",
        "Limits are never guessed.",
        "Add the key.",
    ),
    "profile-name": Code(
        "No profile has this name.",
        "A controller is never guessed.",
        "`wedmcam profile list` prints the names; a profile of your own is a .toml file.",
    ),
    "no-blocks": Code(
        "The file holds no block of this format.",
        "There is nothing to cut.",
        "Check that it is the right file; `wedmcam identify` says what it is.",
    ),
    "bad-record": Code(
        "Text that looks like a 3B record and is none.",
        "The controller would refuse it or read it in another way.",
        (
            "Write `B X B Y B J G Z`: three B, whole micrometres without sign or point, GX or "
            "GY, then L, SR or NR with a quadrant 1 to 4."
        ),
    ),
    "unsupported-4b": Code(
        "A 4B record: it has a radius as its fourth field, and D or DD before G.",
        "4B leaves the offset to the controller; read as 3B it would cut another path.",
        "Write the program as 3B, with the offset computed.",
    ),
    "bad-angle": Code(
        "An angle of a block in rotation format is none: 360 degrees or more, or no arc at all.",
        "The controller would compute another start point.",
        "Correct the exponent or the significand; angles are 0 up to 360 degrees.",
    ),
    "bad-type": Code(
        "An arc has no compensation type: 0x01 or D (convex), 0x02 or DD (concave).",
        "It is not known whether the radius grows or shrinks.",
        "Correct the byte behind the instruction.",
    ),
    "quadrant-contradicts": Code(
        "The instruction names the quadrant opposite to the one that the angle lies in.",
        "The controller corrects a neighbouring quadrant only.",
        "Correct the instruction or the angle.",
    ),
    "radius-contradicts": Code(
        "R of an arc in compensation format is not the distance of its start from the centre.",
        "The arc would be scaled by another factor than its radius.",
        "Correct R, x or y.",
    ),
    "not-tangent": Code(
        "Two blocks of a figure in compensation format do not meet tangentially.",
        "Offset by scaling its arcs alone, the figure would not hold together there.",
        "Round the corner (--corner), or compute the offset in the compiler: --to compact.",
    ),
    "gap-value": Code(
        "The gap is no whole um up to 7.999 mm, or not smaller than the radius of an arc that "
        "shrinks by it.",
        "The controller does not take it; an arc would vanish or turn over.",
        "Another gap, or the offset computed in the compiler: --to compact.",
    ),
    "no-gap": Code(
        "A program in compensation format or 4B was read or written, and no gap was given.",
        "It holds the outline; the wire runs beside it by the gap that is entered.",
        "Give what is entered at the controller: --gap 0.1mm --side part, or --offset for verify; "
        "--gap 0 for the outline itself.",
    ),
    "outline-side": Code(
        "The data do not say on which side of an arc the outline lies, or on which side of a "
        "contour of lines alone outwards is.",
        "The path would be right with the gap it is made for and wrong with every other.",
        "Compile the drawing to the format with the gap, or convert to one that takes any path.",
    ),
    "not-reachable": Code(
        "No numbers of the format make the controller compute this block.",
        "Another path would be cut than the one that was proven.",
        "Another format: --to compact; for G41 and G42 a profile with more digits.",
    ),
    "figure-repeated": Code(
        "The path is one figure and its copies: the file holds the figure.",
        "The controller cuts the part only with the copies, the angle and the leads that are "
        "entered.",
        "Enter what the report names; `verify --copies --angle --lead-in --lead-out` proves it.",
    ),
    "not-repeated": Code(
        "A path that repeats about a centre is written without copies.",
        "The file is longer than it could be, and may not fit the memory.",
        "What the hint says; without it the program is right all the same.",
    ),
    "figure-drift": Code(
        "A figure in rotation format ends beside where it should: its copies do not come back to "
        "their start, or a block leads to another um.",
        "What one figure is off grows over the copies by 1 / sin(pi / N); the contour stays open.",
        "Other headings or lengths; a figure of several (fewer copies); --to compact.",
    ),
    "no-leads": Code(
        "A figure in rotation format is proven without the leads that are entered beside it.",
        "Where the wire is threaded, and what it cuts on the way, is not proven.",
        "--lead-in X,Y and --lead-out X,Y, or --certificate with the certificate of the compile.",
    ),
    "zero-count": Code(
        "The count length J is 0.",
        "Controllers skip such a record in silence or never end it.",
        "Remove the record or correct J.",
    ),
    "endless-block": Code(
        "The count direction is an axis on which the block never steps.",
        "The block never ends: the machine runs on.",
        "Correct G, or the direction of the line.",
    ),
    "arc-too-small": Code(
        "An arc whose start is less than sqrt(2) um from its centre.",
        "The interpolator steps onto the centre and never ends.",
        "Replace the arc by a line.",
    ),
    "over-limit": Code(
        "A number is larger than the format or the profile allows.",
        "It does not fit its field: digits would be lost.",
        ("Split the block, or choose a profile with the limit that the controller really has."),
    ),
    "quadrant-repaired": Code(
        "A block along an axis named the neighbouring quadrant and was corrected.",
        "Controllers correct this too, but not all of them.",
        "Nothing is needed; writing the program again names the right quadrant.",
    ),
    "count-axis": Code(
        "A line is counted on its shorter axis, or not on the axis of the tie rule.",
        (
            "The end is off by up to millimetres, because the last steps on the longer axis "
            "are missing."
        ),
        "Write the program again: G becomes the longer axis.",
    ),
    "more-than-a-turn": Code(
        "An arc whose J is more than a full circle has.",
        "The wire runs round the same circle again.",
        "Correct J, unless this is meant.",
    ),
    "text-skipped": Code(
        "Text around the records that is no record: headers, comments, names.",
        "It is not cut; a record hidden in it would be missing.",
        "Look at the places that are named.",
    ),
    "commented-record": Code(
        "A record inside a comment.",
        "It was not read; some controllers know no comments and would cut it.",
        "Remove it, or take it out of the comment.",
    ),
    "hidden-control-word": Code(
        "A control word stands in a line of other text and was not taken as one.",
        "A pause or a stop may be missing.",
        "Put the control word on a line of its own, or after a semicolon if it is none.",
    ),
    "unknown-word": Code(
        "A bare word that the profile does not know; a control word is kept as a control record.",
        "It is not known what the controller does with it.",
        "Name the control words in the profile ([words]; of ISO what each does, [iso.words]).",
    ),
    "after-end": Code(
        "There is data after the end of the program.",
        "The controller does not run it, or runs it as another program.",
        "Split the file, or remove what follows the end.",
    ),
    "no-end": Code(
        "The program does not say where it ends (no DD; no end byte 0x00).",
        "The controller goes on into whatever the memory holds.",
        "End it so, and check whether the file was cut short.",
    ),
    "bad-instruction": Code(
        "A byte where an instruction is expected that is none.",
        "All that follows cannot be read: the lengths of blocks are not known.",
        "Check the format with `wedmcam identify`; the file may be damaged.",
    ),
    "bad-digit": Code(
        "A half byte of packed BCD is larger than 9.",
        "The number cannot be read.",
        "The file is damaged or has another format.",
    ),
    "truncated": Code(
        "The data end inside a block.",
        "The last block cannot be run.",
        "The file was cut short; get it again.",
    ),
    "over-memory": Code(
        "The program is larger than the controller's memory.",
        "It must be loaded in several parts.",
        "Use `--split`, which cuts it at thread points, and a contour that is longer than the "
        "memory in the kerf, at the end of a block.",
    ),
    "image-size": Code(
        "An image of the ZD-065's memory has not the bytes that the memory has.",
        "More bytes have no address there; what a shorter image does not say is taken to be 0.",
        "Give the bytes of the memory, 4,096 at most, and nothing else.",
    ),
    "image-damaged": Code(
        "Data in the memory are damaged at one place, and blocks follow each other behind it.",
        "The machine would stop there, or run bytes as other blocks than they were.",
        "Put the bytes right; `wedmcam zd065 show` and `find` tell what stands where.",
    ),
    "random-memory": Code(
        "The memory holds no data of the ZD-065's formats: random bytes, or a text.",
        "The machine clears its memory when it recognises random data.",
        "`wedmcam zd065 identify --clear -o FILE` writes a cleared memory; nothing else does.",
    ),
    "not-random": Code(
        "A memory was to be cleared that holds data, or nothing.",
        "Only random data are cleared: a program with a damaged byte can be put right.",
        "Leave --clear out.",
    ),
    "no-such-block": Code(
        "The data in the memory have no block of this number.",
        "An address would be one of other data, or of none.",
        "Count from 1, thread points and pauses included; `wedmcam zd065 identify` tells how many.",
    ),
    "block-parted": Code(
        "A range that is moved begins or ends within a block.",
        "One part of the block stays and is cleared, or runs as another block.",
        "Move whole blocks: `wedmcam zd065 find` tells where they begin.",
    ),
    "memory-overwritten": Code(
        "Data are moved onto bytes that are not 0.",
        "What stood there is lost.",
        "Move them to cleared memory, or be sure that nothing there is wanted.",
    ),
    "kerf-load": Code(
        "The program is one of several loads, and begins or ends within a contour.",
        "The machine waits in the kerf, generator off; the next load starts where it stands.",
        "Load them in their order, and move nothing in between.",
    ),
    "over-travel": Code(
        "The program moves farther than the table.",
        "The machine runs into its limit switches.",
        "Move or turn the part, or split it.",
    ),
    "origin-moved": Code(
        "The places of the drawing do not lie on the table as they are: all of them were moved.",
        "The program's places are not those of the drawing; the path is the same.",
        "Clamp the blank so, or draw the part between zero and the travel of the table.",
    ),
    "vector-speed": Code(
        "At which speed the vectors of a program are run, and into how many the path was cut.",
        "The lower the speed, the coarser are the controller's directions, and the shorter vectors "
        "have to be: at another speed this program leaves its path.",
        "Nothing has to be done; --feed states the speed.",
    ),
    "speed-range": Code(
        "A cutting speed that the controller does not have: it has 1 to 127 times 15.75 um a "
        "minute.",
        "At speed 0 a vector never ends, and a larger number does not fit 7 bits.",
        "State a speed or a --feed in its range.",
    ),
    "generator-words": Code(
        "Control words t(i) and t(p) with which the generator cuts out, or draws more than 2 A.",
        "The supply is overloaded, or the wire runs into the work without a spark.",
        "t(p) at least 119 (7 V), t(i) at most one and a half times t(p).",
    ),
    "bad-job-record": Code(
        "A line that is no job record of the DEM-15.",
        "A vector or a pause of the program would be lost.",
        "Write `x y new-x new-y t(i) t(p) speed`, seven whole numbers, P or E.",
    ),
    "positions-unit": Code(
        "A program of the DEM-15 does not say what its positions count, or counts other units than "
        "the profile.",
        "Read in the other unit the part is cut twice as large, or half.",
        "The first line says UM or STEPS; read it with the profile that counts so.",
    ),
    "place-step": Code(
        "A place of a vector is an odd number of um, and a step is 2 um.",
        "The axis steps past its target and never arrives.",
        "Put places on even numbers.",
    ),
    "place-jump": Code(
        "A vector does not start where the one before it ends.",
        "The controller takes the place for where it stands: all that follows is cut beside the "
        "path.",
        "Look for the record that is missing.",
    ),
    "not-in-format": Code(
        "A block that the format cannot express.",
        "It would be cut otherwise than meant.",
        "Compile for this format, or convert with lowering.",
    ),
    "not-carried": Code(
        "Something of a program has no place in the format that it is converted to.",
        "The path is the same; a pause, a word or an end that the machine minded is missing.",
        "See to it at the machine, or convert to a text format, which keeps words.",
    ),
    "probe-reading": Code(
        "A reading of the probe that cannot be read, or that no known controller gives.",
        "Nothing can be said of the controller, or only of a part of what was asked.",
        "Read that stop again; if it stays so, the controller is of a kind that is not known here.",
    ),
    "other-step": Code(
        "A program that counts steps of one length is to be written for a machine with others.",
        "The numbers would make a part of another size, and no others make the same path.",
        "Compile the drawing for the other machine, or convert the program to .dxf and that.",
    ),
    "conversion-differs": Code(
        "The other format would not step the path of the program that was read within 1 um.",
        "Another part would be cut.",
        "Convert to another format, or compile the drawing for it.",
    ),
    "iso-word": Code(
        "A word of an ISO line that cannot be read, or that stands there twice.",
        "The block could mean another path; it was not read.",
        "Write a letter and a number; a letter other than G and M once in a line.",
    ),
    "iso-code": Code(
        "An ISO code, or an axis, that is not known here and may change the path.",
        "What a controller would cut is not known.",
        "Name the profile that knows it (--profile-in); or remove it, if the machine does not need "
        "it. Programs here are flat.",
    ),
    "iso-ignored": Code(
        "An ISO word without an effect on the path: feed, generator, table, the number of the "
        "program, a motion of length 0.",
        "It is not in the program that is proven, nor in one that is converted.",
        "Nothing is needed; set these things at the machine.",
    ),
    "iso-harmless": Code(
        "Words of an ISO program that change no path, as the profile of its machine says.",
        "They are not in the program that is proven; a conversion loses them (`not-carried`).",
        "Nothing is needed; what they do is to be seen to at another machine.",
    ),
    "iso-start": Code(
        "An ISO program cuts to a place first, and does not say where the wire stands before.",
        "The first cut is taken to start at X0 Y0; of a wire that is threaded elsewhere it is "
        "another line.",
        "Write G92 with the place of the wire in front of the first cut.",
    ),
    "iso-compensation": Code(
        "G41 or G42: the controller is to offset the path by a table of its own.",
        "The path depends on a number that is not in the file.",
        "Give the table: --d 1=0.1mm for D1, as it is entered at the controller.",
    ),
    "iso-offsets": Code(
        "What the entries of a table of offsets are: one in the file (H001 = 0.14), diameters, D0, "
        "or another entry in the middle of a path.",
        "They say by how much G41 and G42 offset the path; --d wins over the file.",
        "Compare them with what is entered at the machine.",
    ),
    "iso-d": Code(
        "G41 or G42 with a D that is missing, is no number of an offset, or was not given.",
        "By how much the controller would offset the path is not known.",
        "Write D with G41 or G42, and give its offset: --d 1=0.1mm.",
    ),
    "compensation-place": Code(
        "Compensation is switched on, off or over where controllers differ, or never followed.",
        "One controller refuses it, another cuts a path of its own.",
        "Lead in and out on straight lines (G01), with one side and one D between them; what "
        "another D does, offset_change of a profile may say.",
    ),
    "compensation-lead": Code(
        "The lead to an outline that the controller offsets is too short or on the wrong side.",
        "Controllers stop with an alarm, or the wire cuts into the part.",
        "Start farther from the outline, on the side of the wire: --start; beside a .zdc file "
        "--lead-in X,Y --lead-out X,Y.",
    ),
    "compensation-lost": Code(
        "The controller cannot offset a block: nothing is left of it, it comes too near to another "
        "one, or it runs back on one.",
        "Controllers look one block ahead: they stop with an alarm, or cut into the part.",
        "A smaller offset or larger inside radii; or let wedmcam compute the offset.",
    ),
    "iso-arc": Code(
        "An ISO arc whose centre, radius and end do not fit each other.",
        "Controllers refuse it, or cut a spiral, a full circle or the other arc.",
        "Correct I and J (from the start to the centre) or R.",
    ),
    "iso-end": Code(
        "The stepped circle of an arc passes beside its stated end, by a micron or a few.",
        "Controllers go the rest straight; each rounds a little otherwise.",
        "Nothing is needed; writing the program again makes arcs that end exactly.",
    ),
    "iso-units": Code(
        "The unit of a number in an ISO program is in doubt: nothing says what 1 is.",
        "Read as um instead of mm the part is a thousand times too small, as mm for inch 25 times.",
        "Say it: --whole-in for numbers without a point, --units-in for those with one where no "
        "G20 or G21 stands; or name the profile of the machine, --profile-in.",
    ),
    "iso-coordinates": Code(
        "An ISO program moves before it says G90 or G91.",
        "Numbers that are places to one machine are ways to the next: another path is cut.",
        "Say it: --coordinates-in absolute or incremental; or --profile-in.",
    ),
    "iso-centres": Code(
        "Nothing in an ISO program proves whether I and J lead from the start or are a place.",
        "A full circle fits both rules, and they are two circles of different size and place.",
        "Say it: --centres-in start or absolute; or --profile-in.",
    ),
    "iso-semicolon": Code(
        "Text behind a semicolon in an ISO program reads as words.",
        "To one controller a semicolon ends the block, to the next it begins a comment: motions "
        "would be left out, or comments cut.",
        "Say it: --semicolon-in block or comment.",
    ),
    "iso-stated": Code(
        "An ISO program itself says otherwise what an option says of it.",
        "The machine obeys the program; the option had no effect.",
        "Leave the option out, or correct the program.",
    ),
    "subprogram": Code(
        "A call of a subprogram in an ISO program (M98, M99, M97, M198, M199, L, P) cannot be run.",
        "The lines of a subprogram are cut where it is called, as often as it is called; in the "
        "order of the file, or from another line, they are another path. One controller looks for "
        "N0001 in the file where M98 P0001 stands, the next for the program O0001.",
        "Say which: --subprograms-in N-label or O-number, or --profile-in of the machine; correct "
        "the call; or write the lines of the subprogram in its place.",
    ),
    "subprogram-run": Code(
        "Subprograms of an ISO program are run.",
        "A line of the file is more than one block then: the note says which subprograms are run, "
        "how often, and how many blocks that makes.",
        "Nothing, if that is what the machine does.",
    ),
    "default-profile": Code(
        "A program was written with the default profile of its format, which was another before.",
        "ISO programs are in mm with a point now, with G21 and G90 in them: controllers that read "
        "them mean the same. In whole um (iso-um) one that takes numbers for mm goes metres.",
        "Nothing is needed; name the profile (--profile, or in a wedmcam.toml) and it is not said.",
    ),
    "reads-only": Code(
        "A program was to be written with a profile that only reads programs.",
        "No source states enough of that machine's words to write for it, and a program in words "
        "that it may not take is none.",
        "Write with a profile that writes, or with one of your own made for the machine; "
        "`wedmcam profile show NAME` prints one to start from, and `writes` is one of its keys.",
    ),
    "feed-assumed": Code(
        "No cutting speed was given, and the controller demands F in a program.",
        "The F of the profile is written; it may be too fast for the plate.",
        "Give --feed, a length a minute; or set feed_um in a profile of your own.",
    ),
    "feed-raised": Code(
        "F is below the slowest speed that the controller goes.",
        "It cuts faster than is asked for: the wire may touch, and break.",
        "Give a --feed of that speed or more, or change the limit in the controller and in the "
        "profile (feed_least_um).",
    ),
    "header-mode": Code(
        "The header of an ISO profile leaves a mode in force that no step of the proof sees.",
        "G64 rounds corners for speed, in LinuxCNC without P however far; in G93 and G95 F is a "
        "time, or a way a turn.",
        "Leave the code out of the header, or put G61 and G94 behind it.",
    ),
    "over-line": Code(
        "A line of an ISO program is longer than the controller takes.",
        "The controller refuses it, or runs what fits: a header would set half of its modes.",
        "Shorten the line; header and footer of a profile may be several lines.",
    ),
    "iso-skip": Code(
        "A block that the operator may skip (/), or an optional stop (M01).",
        "The machine cuts another path with block skip on; with the optional stop off it goes on.",
        "Remove the slash or the block; M01 where it is off.",
    ),
    "lone-line": Code(
        "A cut of one line alone between two pauses.",
        "In 3B it would be read as a move with the wire off.",
        "Write the line as two.",
    ),
    "thread-mark": Code(
        "A pause stands behind a move, where the format has a thread point.",
        "The return after a wire break ends at thread points, not at pauses.",
        "Nothing is needed; written again, it is a thread point.",
    ),
    "pause-added": Code(
        "A control record that the format needs was added.",
        "3B marks a move by a pause before and after it.",
        "Nothing is needed.",
    ),
    "ratio-line": Code(
        "A line whose X and Y are a ratio and not its whole length.",
        "Its end is not on a whole micrometre; controllers that take X and Y literally cut less.",
        "Write the line with its whole length.",
    ),
    # --- the judge -------------------------------------------------------------------------
    "path-deviation": Code(
        "The stepped path leaves the exact wire path by more than the limit.",
        "The part would be cut to another shape from this block on.",
        "The program is not the drawing's: compile again, or look at the block named.",
    ),
    "wrong-order": Code(
        "The program follows the wire path backwards, twice, or not in its order.",
        "The machine would cut over a cut, or against the sense that was asked for.",
        "Compile again; an old program can be judged without its order.",
    ),
    "not-closed": Code(
        "A closed contour whose program does not end on the micron where it started.",
        "The cut leaves a step, and every later contour is shifted by as much.",
        "Compile again; look for a count length J that was edited.",
    ),
    "gouge": Code(
        "The wire with its spark gap enters the material that is to be kept.",
        "The part is scrap.",
        "Check the side (part or die), the offset, and where the wire is threaded.",
    ),
    "missing-piece": Code(
        "A piece of the part's outline that the wire could reach is not cut.",
        "The piece does not come loose, or material is left on it.",
        "Check the offset (radius, not diameter) and that every contour is cut.",
    ),
    "uncut-corner": Code(
        "Places of the outline that the round wire cannot reach.",
        "Inner corners keep the radius of the wire.",
        "Nothing is needed; a thinner wire or a corner radius would fit better.",
    ),
    "thread-point": Code(
        "A cut does not start, or end, exactly at its thread point.",
        "The wire would be threaded beside the start hole, or the program ends elsewhere than it "
        "should.",
        "Check where the program starts in the drawing, its last blocks, and the moves between "
        "cuts.",
    ),
    "missing-cut": Code(
        "A contour of the plan is not in the program.",
        "The contour stays uncut.",
        "Compile again; look for records that were lost.",
    ),
    "extra-cut": Code(
        "The program cuts something that the plan does not ask for.",
        "The wire cuts where nothing is to be cut.",
        "Compile again; look for records that were pasted twice.",
    ),
    "cut-twice": Code(
        "A cut is run once more than the plan asks for.",
        "The wire runs through a kerf that is there already, and the piece may be loose by then. A "
        "second pass may be meant; a program that was compiled here has none.",
        "Check that it is meant; else compile again, and look for blocks that were pasted twice.",
    ),
    "stop-point": Code(
        "The pause before the end of a contour is missing, is too many, or is at another place.",
        "The piece may fall and break the wire before the operator holds it.",
        "Compile again with the stop length that is wanted.",
    ),
    "block-limit": Code(
        "A block holds a number over the limit of the machine.",
        "The machine refuses the block, or drops its first digits.",
        "Compile for this machine's profile: blocks over a limit are split.",
    ),
    "empty-block": Code(
        "A cutting block that makes no step.",
        "Some controllers delete it in silence, others run on for ever.",
        "Remove the block.",
    ),
    "stepped-differs": Code(
        "Written for controllers that recompute arc ends; one that counts steps does otherwise.",
        "On a controller that counts steps the contour is off by the figure given.",
        "Compile with --count exact for a controller that counts steps.",
    ),
    "origin-fitted": Code(
        "Where the program starts in the drawing was found by fitting.",
        "The program itself does not say it.",
        "State it with --origin to have it checked.",
    ),
    "origin-unknown": Code(
        "A program proves on none of the thread points that are given.",
        "The whole of it may be displaced: on another start than the drawing's the part is cut at "
        "another place of the workpiece.",
        "State --origin X,Y, or take the place that fits with --fit-origin and look at it.",
    ),
    "other-leads": Code(
        "The way in or out of a contour, or a pause, is another than planned.",
        "It was proven to stay out of what is kept and off other cuts, and no more.",
        "Nothing is needed where the program is from elsewhere; look at it with wedmcam plot.",
    ),
    "other-order": Code(
        "The program cuts the part, in another order, sense or with other leads than planned.",
        "Nothing: the part is what is proven.",
        "Nothing is needed.",
    ),
    "no-fit": Code(
        "No place in the drawing was found at which the program cuts its contours.",
        "The program is of another part, offset, size or rotation.",
        "Check the drawing, the offset and the units, or state --origin.",
    ),
    "not-an-image": Code(
        "The part rotated, mirrored, run the other way or threaded elsewhere has another program.",
        "A fault of one quadrant or sense, in the compiler or in the profile.",
        "Do not use the program; compare both images with wedmcam plot.",
    ),
    # --- tape of the NBY-15 ----------------------------------------------------------------
    "tape-parity": Code(
        "A row of a punched tape has an odd number of holes.",
        "A hole is missing or torn, or was read where there is none: the block would say another "
        "number. The reader of the machine stops with TAPE.",
        "Punch the tape again; rows are counted from the first one of the file.",
    ),
    "tape-start": Code(
        "A tape has no %, or characters in front of it.",
        "The reader begins behind the first %; what stands in front of it is never run.",
        "Punch the tape again; look whether its beginning was cut off.",
    ),
    "tape-block": Code(
        "A line of a tape that is no block.",
        "What it would move is not known, and everything behind it would lie elsewhere.",
        "Write G01 X Y, G02 or G03 A B R, G00 X Y, M00 or M02, one block a line.",
    ),
    "tape-sequence": Code(
        "The N numbers of a tape do not follow one another.",
        "A block is missing, stands twice or elsewhere: all coordinates are incremental, so "
        "everything behind it would be cut beside its place.",
        "Compile again, and punch the whole tape.",
    ),
    "degree-polygons": Code(
        "The controller makes arcs of straight moves, one a degree.",
        "A large arc is cut flatter than drawn, inside its circle, by the figure given.",
        "Nothing, where the figure will do; else a controller with an interpolator for arcs.",
    ),
    "radius-corrector": Code(
        "How far the radius corrector of the NBY-15 may be turned with this tape.",
        "It changes the radius of every arc and nothing else: where blocks do not join "
        "tangentially, or beyond the smallest radius, the path tears, or the machine runs off on a "
        "huge radius.",
        "Keep within the value; for more, compile with another --offset.",
    ),
    "limit-switch": Code(
        "The simulated machine ran into a limit switch.",
        "The wire leaves the part, and cuts what is in its way.",
        "Set the radius corrector to no more than is safe for the tape, and the scale so that the "
        "path keeps within the travel.",
    ),
    # --- files and the command line --------------------------------------------------------
    "certificate-differs": Code(
        "A certificate says something else than is found now.",
        "It was changed, or it is of another program or drawing than is there.",
        "Compile again, or look which of the files was changed.",
    ),
    "settings-syntax": Code(
        "A wedmcam.toml is no TOML, or cannot be read.",
        "Its defaults (wire, gap, profile) would be missing from every program.",
        "Correct the place named; --no-config compiles without it.",
    ),
    "settings-key": Code(
        "A wedmcam.toml holds a key that is no option, or one that is no default.",
        "A misspelt offset would be no offset.",
        "Take the name that is proposed; `wedmcam config` lists all.",
    ),
    "settings-value": Code(
        "A wedmcam.toml gives an option a value that it does not take.",
        "The option would keep another value than the shop means.",
        "Write the value as on the command line; lengths are text with a unit, or mm.",
    ),
    # --- simulating a machine --------------------------------------------------------------
    "no-backlash": Code(
        "The backlash of x and y is not entered.",
        "The controller refuses to cut: without these figures every reversal would leave the play "
        "of the screw in the part.",
        "Give --backlash X,Y in um, as measured at the machine; 0,0 for one without play.",
    ),
    "other-format": Code(
        "The program is not in the format that the simulated controller reads.",
        "Each controller runs its own format; bytes of another one mean something else to it.",
        "Convert the program: wedmcam convert PROGRAM -o NAME.zd, and what is entered beside it.",
    ),
    "empty-program": Code(
        "The program makes no step.",
        "There is nothing to simulate; an empty program would look like success.",
        "Look at it with wedmcam dump.",
    ),
    "bad-script": Code(
        "A line of a script for a panel names no key, and nothing that happens.",
        "A line that is passed over would leave the machine in another state than meant.",
        "Write keys, 0 to F and U0 to U7, or one of the words that the message lists.",
    ),
    "bad-scenario": Code(
        "The scenario of a simulation cannot be read, at the line named.",
        "A fault that is left out in silence would show a machine that never failed.",
        "Put the line right; docs/zd065.md has an example of every entry.",
    ),
    "bad-fault": Code(
        "A fault cannot happen where it is stated.",
        "It would be left out, and the run would seem to have stood it.",
        "State a step that the program makes, with the generator on for shorts and breaks.",
    ),
    "fault-passed": Code(
        "A run goes on from a saved state, and some of its random faults happened before that.",
        "The same seed draws the same faults: a run in two parts has each of them once.",
        "Nothing is to be done; another --seed draws other faults.",
    ),
    "bad-state": Code(
        "The saved state of a controller is damaged, or contradicts the program.",
        "A machine that goes on from a wrong place cuts into the part.",
        "Take the state as it was written; a program cannot go on from another place.",
    ),
    "other-program": Code(
        "The saved state belongs to another program.",
        "The machine would go on in the middle of a wrong path.",
        "Give the program that was running when the state was saved.",
    ),
    "alarm": Code(
        "The simulated machine stopped with an alarm, before the end of the program.",
        "After 100 um back the short circuit is still there: the part is not cut to its end.",
        "Give --state FILE, and go on with --resume FILE when the fault is cleared.",
    ),
    "table-off": Code(
        "The table of the simulated machine did not follow the path exactly.",
        "Backlash that is entered wrong shifts every stretch behind a reversal by the difference.",
        "Measure the play of both screws again; give the true direction of the last approach.",
    ),
}
