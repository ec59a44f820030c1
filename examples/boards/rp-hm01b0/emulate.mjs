// node emulate.mjs ELF FRAME.raw FRAMES: runs the firmware for the RP2040 in rp2040js, with a camera at its pins that shows
// a frame of 324 × 244 grey pixels again and again. What the firmware logs (RTT) goes to standard output, undecoded.
import { RP2040 } from 'rp2040js';
import { SimulationClock } from './node_modules/rp2040js/dist/esm/clock/simulation-clock.js';
import { readFileSync, writeSync } from 'fs';
import { execFileSync } from 'child_process';

const [elfPath, framePath, frameCount] = process.argv.slice(2);
const [COLUMNS, ROWS, FRAMES] = [324, 244, Number(frameCount)];
const [PINS, PCLK, LVLD, FVLD] = [6, 14, 15, 16];
const [MCLK_HZ, CYCLE_NS] = [12.5e6, 8];
const MOST_NS = 1e9 * (FRAMES + 1);
const frame = readFileSync(framePath);
if (frame.length !== COLUMNS * ROWS) throw new Error(`${framePath} has ${frame.length} bytes, but must have ${COLUMNS * ROWS}`);

const clock = new SimulationClock();
const chip = new RP2040(clock);
chip.logger = { debug() {}, info() {}, warn() {}, error(component, text) { console.error(component, text); } };

// What the boot ROM and the boot loader do: the program lies in flash, and its vector table has stack and start.
const elf = readFileSync(elfPath);
const FLASH = 0x10000000;
for (let segment = 0; segment < elf.readUInt16LE(44); segment++) {
    const header = elf.readUInt32LE(28) + 32 * segment;
    const [type, offset, , address, size] = [0, 4, 8, 12, 16].map((at) => elf.readUInt32LE(header + at));
    if (type === 1 && address >= FLASH && address < 2 * FLASH) {
        chip.flash.set(elf.subarray(offset, offset + size), address - FLASH);
    }
}
const VECTORS = FLASH + 0x100;
chip.core.VTOR = VECTORS;
chip.core.SP = chip.readUint32(VECTORS);
chip.core.PC = chip.readUint32(VECTORS + 4) & ~1;
// A DMA transfer ends as soon as it is aborted, but the emulator does not know the register that says so.
const CHAN_ABORT = 0x444;
const readDma = chip.dma.readUint32.bind(chip.dma);
chip.dma.readUint32 = (offset) => (offset === CHAN_ABORT ? 0 : readDma(offset));
let stopped = null;
chip.onBreak = (code) => { stopped = `a breakpoint (${code})`; };

// The camera's registers, at 0x24 on I2C: two bytes of address, then data.
const registers = new Map([[0x0000, 0x01], [0x0001, 0xb0], [0x3060, 0x08]]);
let selected = false, written = [];
const bus = chip.i2c[0];
const address = () => (written[0] << 8) | written[1];
bus.onStart = () => { written = []; bus.completeStart(); };
bus.onConnect = (device) => { selected = device === 0x24; if (selected) written = written.slice(0, 2); bus.completeConnect(selected); };
bus.onWriteByte = (byte) => {
    written.push(byte);
    if (written.length > 2) registers.set(address() + written.length - 3, byte);
    bus.completeWrite(selected);
};
let read = 0;
bus.onReadByte = () => bus.completeRead(registers.get(address() + read++) ?? 0);
bus.onStop = () => { read = 0; written = []; bus.completeStop(); };

// Its pins: half a period of its pixel clock after the other. The timing is that of its registers.
const register = (at) => registers.get(at) ?? 0;
const word = (at) => (register(at) << 8) | register(at + 1);
const pin = (number, level) => chip.gpio[number].setInputValue(!!level);
let [column, line, half, frames, due] = [0, 0, 0, 0, 0];
function step() {
    const isRow = line < ROWS, isPixel = isRow && column < COLUMNS;
    if (half === 0) {
        if (column === 0) pin(FVLD, isRow);
        pin(LVLD, isPixel);
        if (isPixel) for (let bit = 0; bit < 8; bit++) pin(PINS + bit, (frame[line * COLUMNS + column] >> bit) & 1);
    }
    // The clock stands still between rows.
    if (isPixel) pin(PCLK, half);
    if (!isPixel && half === 0) pin(PCLK, 0);
    half = 1 - half;
    if (half === 0 && ++column >= word(0x0342)) {
        column = 0;
        if (++line >= word(0x0340)) { line = 0; frames++; }
    }
    due += 0.5e9 * (8 >> (register(0x3060) & 3)) / MCLK_HZ;
}

// The log: SEGGER's ring buffer, which a debug probe empties while the program runs.
const symbols = execFileSync('nm', [elfPath]).toString();
const rtt = parseInt(symbols.match(/^([0-9a-f]+) . _SEGGER_RTT$/m)[1], 16) + 24;
function drain() {
    const [buffer, size, write, start] = [4, 8, 12, 16].map((at) => chip.readUint32(rtt + at));
    const bytes = [];
    for (let at = start; size && at !== write; at = (at + 1) % size) bytes.push(chip.readUint8(buffer + at));
    if (bytes.length) { writeSync(1, Buffer.from(bytes)); chip.writeUint32(rtt + 16, write); }
}

// The state machines would run by timers of the host: here one step for each cycle of the processor.
for (const pio of chip.pio) pio.run = () => {};
const advance = (cycles) => {
    for (let cycle = 0; cycle < cycles; cycle++) chip.pio[0].step();
    clock.tick(cycles * CYCLE_NS);
};
for (let steps = 0; frames < FRAMES && !stopped; steps++) {
    advance(chip.core.waiting ? 4 : chip.core.executeInstruction());
    if (register(0x0100) === 1) { if (due === 0) due = clock.nanos; while (clock.nanos >= due) step(); }
    if ((steps & 255) === 0) drain();
    if (clock.nanos > MOST_NS) stopped = `${clock.nanos / 1e6} ms without ${FRAMES} frames`;
}
drain();
if (stopped) { console.error(`stopped by ${stopped} at ${chip.core.PC.toString(16)} after ${frames} frames`); process.exit(1); }
