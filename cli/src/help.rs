//! The longer texts of `--help`.

pub(crate) const EXAMPLES: &str = "\
Examples:
  shutter-range inspect frame-*.jpg
  shutter-range setup > camera.toml
  shutter-range table2
  shutter-range edges edges.csv --setup camera.toml
  detect-edges video.mp4 | shutter-range edges - --setup camera.toml --json
  shutter-range frame frame.png --setup camera.toml --overlay seen.png
  shutter-range simulate --setup camera.toml --out simulated
  shutter-range calibrate flicker frame-*.png --frequency-hz 100
  shutter-range calibrate scale passes.csv --focal-px 600
  shutter-range plan --setup camera.toml --from 0.5 --to 10
  shutter-range figures figures
  shutter-range sensors

Exit code: 0 done, 1 an input is wrong or an output cannot be written, 2 the command line is wrong.";

pub(crate) fn edges() -> String {
    [EDGE_COLUMNS, SMALLEST_SETUP, CAMERA_FILES, FRAME_TIMES, TRAJECTORY, STATUSES, POSTS, EDGE_EXAMPLES].join("\n\n")
}

pub(crate) fn frame() -> String {
    [FRAMES, CAMERA_FILES, FRAME_TIMES, TRAJECTORY, STATUSES, POSTS, OVERLAY, FRAME_EXAMPLES].join("\n\n")
}

const EDGE_COLUMNS: &str = "\
Columns:
  row, column   of an edge point, in pixels: row 0 is the top of the image, pixel centres are at whole
                numbers
  time_s        middle of the row's exposure since frame start, within the frame that the readout allows;
                default, also where stamps do not rise at the readout's pace: from row and readout
  line          a whole number: points with the same number are one line; without it, a tracker finds
                the lines
  frame         a whole number; frames are independent of each other, or one sequence with
                --frame-interval-s (from one number to the next) or --frame-times
  polarity      rising (dark to bright from left to right) or falling; empty: unknown
  sigma_px      noise of the column, one standard deviation; default: camera.sigma_column_px of the setup
  width_px      one sigma of the edge's blur, 0 to 255; 0 or empty: not measured. Beside a known
                camera.exposure_s it shows which edges lean
A file has at most 256 MiB.";

const SMALLEST_SETUP: &str = "\
Smallest setup:
  [camera]
  columns = 640
  rows = 480
  fx = 600            # pixels
  readout_s = 0.0333  # whole frame
  [motion]
  velocity_m_s = [1.5, 0, 0]  # x right, y down, z forward
All keys: shutter-range setup";

pub(crate) const SETUP: &str = "\
A sensor is called by the beginning of its name and mode in shutter-range sensors, in small letters with
hyphens: ov7725-qvga. What a sensor or a camera file does not tell is named at the top of the file.

Examples:
  shutter-range setup > camera.toml
  shutter-range setup --sensor ov7725-qvga --clock-mhz 12 > camera.toml
  shutter-range setup --camera camera_info.yaml > camera.toml";

const CAMERA_FILES: &str = "\
Camera files: ROS camera_info (YAML, also as a message), OpenCV's YAML and XML, Kalibr's camchain with its
line_delay, lens profiles of Gyroflow, whose readout below zero is one from the bottom to the top. Lenses of
five or eight coefficients as they are, fisheye lenses up to 60 degrees off the axis as rational ones. What
such a file has must not be said otherwise in the setup; what it lacks is asked for.";

const FRAME_TIMES: &str = "\
Frame times: seconds of any clock, one line for each frame in their order; with a column name, in any
order and perhaps of more frames than are given. A frame is called by its path, its file name or, from a
file of edges, its number. The next frame starts when this one has been read, or later. A column
exposure_s has the exposure of each frame, where automatic exposure changes it, in place of the setup's.";

const FRAMES: &str = "\
Frames must be as the sensor read them: of the setup's size, neither cropped, scaled nor rotated (the
orientation noted in a JPEG is not applied). Colour is converted to luma. Grey levels of more than 8
bits are scaled by their own range (MAXVAL of a PGM, camera.bits of the setup, otherwise 16 bits) and
rounded to 8 bits: steps below a 255th of that range are lost, which is a noise of 0.3 levels. A file
holds one frame, or is a y4m video (.y4m, or - for standard input), whose frames are called by their
numbers from 0; its grey levels are taken as they are. A JPEG that has lost bytes is torn, and so is a
frame whose edges all jump at one row, or step aside wherever pulsed light changes: nothing of it is
told. A file that cannot be read is reported on standard error, the others still give ranges, and the
exit code is 1.";

const TRAJECTORY: &str = "\
Trajectory: each line has the velocity (m/s) and the rotation rate (rad/s) of one instant in the axes
of the camera at that instant; time_s is counted from the start of the first frame, which is the middle
of the exposure of the row read first. gx,gy,gz is the direction of down in the same axes; without it,
that of the setup's [attitude] at the start of the first frame, propagated by the rotation. It must be
left out where the setup says that gravity is learned or fitted. Values are
interpolated linearly, over gaps of at most three times the usual interval, which of samples in bursts is
that of the bursts. Columns may be missing: they are zero. A sample that is there twice counts once; where
most stamps repeat, the samples of a tick are spread over it; elsewhere two values of one instant are a
jump. With [mount] in the setup, all is in the axes of the robot. Uncertainties are those of the setup,
whose [motion] may leave out the velocity.";

const STATUSES: &str = "\
Statuses:
  ok            a straight upright edge, inverse depth above three sigma
  far           inverse depth within three sigma of zero: only a lower bound of the depth is known
  slow          the motion says too little: sigma of inverse depth above 0.33 per metre
  inconsistent  inverse depth below minus three sigma: the slope is against the motion
  leaning       the edge leans more than its prior allows, by its own fit or its blur
  moving        several frames show the edge where a static one cannot be
  bent          no straight line fits
  cluttered     so much texture around it that the line may be one by chance
  short         too few rows
  sideways      upright edges run along the rows: the camera lies on its side or looks up or down
  tentative     in a sequence, with --all: a line that is cluttered, short, or new among known edges,
                until three frames agree, and more than chance would make them
Only ok has a depth. Where several apply, the first that makes the depth worthless is reported.";

const POSTS: &str = "\
Two edges of opposite polarity that are alike in ends and slope are the sides of one post, whose middle
is free of its taper. Hints under the table say what may be wrong with the setup or the pictures.";

const OVERLAY: &str = "\
Overlay:
  green, thick  ok: distance and one sigma beside the edge
  blue, thick   far: lower bound of the distance beside the edge
  orange, thin  inconsistent, leaning, moving, bent, cluttered or sideways
  grey, thin    slow, short or tentative
The distance is the shortest to the edge's line, distance_m of --json. In a sequence the number of frames
that an edge rests on follows in parentheses. An overlay, a map or a report that is there already is
replaced; one that would replace a file that is read is refused.";

const EDGE_EXAMPLES: &str = "\
Example:
  shutter-range edges edges.csv --setup camera.toml --json | jq '.frames[].ranges[].depth_m'";

const FRAME_EXAMPLES: &str = "\
Examples:
  shutter-range frame frame.png --setup camera.toml --overlay seen.png
  shutter-range frame *.jpg --setup camera.toml --overlay seen.png   # seen-0001.png, seen-0002.png, ...
  shutter-range frame *.png --setup camera.toml --frame-interval-s 0.0333 --trajectory drive.csv
  shutter-range frame frame.png --setup motion.toml --camera camera_info.yaml --report ranges.html
  ffmpeg -i drive.mp4 -f yuv4mpegpipe - | shutter-range frame - --setup camera.toml --frame-interval-s 0.0333
  shutter-range frame *.png --setup camera.toml --json-lines > ranges.jsonl
  shutter-range frame *.png --setup camera.toml --frame-interval-s 0.0333 --map drive.svg
  shutter-range frame dump.bin --raw 320x240:yuyv --setup camera.toml --json";

pub(crate) const SIMULATE: &str = "\
The camera is that of the setup, a pinhole without distortion, with its exposure_s (default 2 ms) and
lens_blur_px (default 0.7). It continues with the setup's motion from frame to frame. truth.json has the
edges of each frame and the camera's motion in the axes at that frame's start. Where the camera turns,
setup.toml therefore holds for the first frame alone, or for all of them with --frame-interval-s.
trajectory.csv has the motion as wheels and a gyroscope would tell it, 200 samples a second, for --trajectory
and for calibrate imu: in the axes of the camera, or those of the robot where the setup has [mount].

The folder must be new or empty. With --overwrite, an earlier simulation in it is replaced: a folder that
holds truth.json, scene.toml and setup.toml. Files with other names stay. The files appear in the folder when
all of them are written. Until then it is unchanged, and after an interruption the same command can simply be
given again.

A scene:
  [background]
  level = 190         # grey level, 0 to 255
  contrast = 10       # of a smooth random texture; default 0
  cell = 0.1          # size of the texture's spots as x/z; default
  seed = 0            # of the texture: another one gives another texture; default
  [[bar]]             # up to 64 bars and rails
  bearing = -0.2      # x/z of its middle
  depth_m = 3.0
  width_m = 0.1
  level = 40
  top_m = -2.0        # ends, downwards from the camera's height; default: beyond the image
  bottom_m = 1.2
  lean_deg = 0.0      # default; positive leans to the left at the top
  [[rail]]            # horizontal, without ends
  depth_m = 6.0
  top_m = 0.9
  bottom_m = 1.0
  level = 230
  [sensor]            # noise: one sigma in grey levels, and variance per grey level
  read_noise = 1.0
  shot_gain = 0.05
  [lamp]              # that lights all of it; default: steady light
  frequency_hz = 1000
  depth = 0.5         # share of the light that flickers; default 1
  duty = 0.3          # pulses of this share of the period; default: a sine

Example:
  shutter-range simulate --setup camera.toml --out simulated --frames 10
  shutter-range frame simulated/frame-*.png --setup simulated/setup.toml --frame-interval-s 0.0333333333";

pub(crate) const FLICKER: &str = "\
Point the camera at anything evenly lit by the lamp alone, hold it still, switch auto-exposure off and take
some frames. Bands along the rows must show, and move from frame to frame: the exposure must be no whole
number of the lamp's periods, and the lamp's frequency no multiple of the frame rate.

Statuses: ok, too_few_frames, no_bands, exposure_of_periods, too_few_periods, inconsistent, ambiguous,
moving. Without a line time the exit code is 1.

Examples:
  shutter-range calibrate flicker frame-*.png --frequency-hz 100   # a lamp on mains of 50 Hz
  shutter-range calibrate flicker frame-*.png --frequency-hz 1000 --svg bands.svg --json";

pub(crate) const SCALE: &str = "\
Columns:
  speed_m_s       of the edge along the rows: positive where the camera moves to the left
  distance_m      depth of the edge: along the optical axis
  slope           of the edge in the image, pixels per row; or
  angle_deg       the same as an angle; or
  frame           a picture, whose longest edge is taken, as seen from the folder of the file
  readout_s       of the frame, where it differs from pass to pass; then kappa is fitted
  bearing         x/z of the edge, and
  heading_deg     angle of the motion to the image plane, as the paper's omega; default 0
  sigma_deg       how much the edge leans, one standard deviation; default 0.1
  sigma_relative  how well speed over distance is known; default 0
Pass in both directions, or at different speeds and distances: otherwise a tilt looks like a scale.

Statuses: ok, too_few_passes, too_many_passes, alike, reversed, contradictory. Without a scale the exit code
is 1.

Example:
  shutter-range calibrate scale passes.csv --focal-px 600 --svg passes.svg";

pub(crate) const IMU: &str = "\
Stand still, some metres from door frames, posts or window frames, and turn the camera back and forth by some
ten degrees for some seconds, about once a second. The trajectory has the gyroscope's rates (and perhaps
gravity, from an accelerometer) on its own clock; its velocities are not used. Without gravity that of the
setup is taken to be the same in all frames: turn about the vertical. attitude.sigma_tilt_deg is how much the
edges themselves may lean, motion.sigma_rate_rad_s the gyroscope's noise within a frame.

Statuses: ok, too_few_lines, inconsistent; without a result the exit code is 1. At rest roll and pitch are
told, and no offset.

Example:
  shutter-range calibrate imu frame-*.png --setup camera.toml --trajectory gyro.csv --frame-interval-s 0.0333";

pub(crate) const PLAN: &str = "\
The post is 12 cm wide and 1 m high with a contrast of 110 grey levels, unless options say otherwise. Sigma is
that of one edge in one frame, with all that the setup states as uncertain.

Examples:
  shutter-range plan --setup camera.toml --from 0.5 --to 10
  shutter-range plan --setup vga.toml --setup qvga.toml --sigma 0.2 --slowest-m-s 0.5 --fastest-m-s 2";

pub(crate) const INSPECT: &str = "\
Give frames as the camera delivers them, best of a scene with some dark and bright upright things: several
frames tell more, a camera at rest tells the blur of its lens. A frame tells nothing of what it does not
show: without isolated upright edges neither blur nor halos, without dark and bright parts no tone curve.

Findings:
  alternating    a Bayer mosaic or YUYV read as grey
  unused bits    levels of 10 or 12 bits in a container of 16
  clipped        black or white pixels
  halos          sharpening
  denoised       noise that neighbours share, or none at all
  mosaic         colours interpolated from a mosaic
  blocks         JPEG or a video codec at a low quality
  offsets        columns or rows that are brighter than their neighbours
  coarse levels  grey levels that never occur
  bands          a light that flickers
  soft           blurred edges

Examples:
  shutter-range inspect frame-*.png
  shutter-range inspect *.jpg --json | jq '.findings[].name'";

pub(crate) const SENSORS: &str = "\
The line time is that from one row of the image to the next, for camera.line_time_us of a setup: the
sensor's own, times the lines that it spends on a row. The readout is that of all rows, for
camera.readout_s.

  measured    somebody measured a frame rate with these settings, and it agrees
  computed    it has the frame rate, or the clock, that a driver or a data sheet states
  documented  it follows from descriptions of the registers alone
Sigma is that of the sensor's formula, for a clock that is right to its last stated digit.

Example:
  shutter-range sensors --json | jq '.modes[] | select(.sensor == \"OV2640\")'";
