//! Machine code, instruction by instruction.

use iced_x86::{Code, Encoder, Instruction, MemoryOperand, Register};

/// Frames and constants are counted from the middle of what one byte of displacement reaches.
pub const FRAME_BIAS: i64 = 128 * 64;
/// See [`FRAME_BIAS`].
pub const POOL_BIAS: i64 = 128 * 4;

const BUFFERS: [Register; 11] = [
    Register::RDX,
    Register::RCX,
    Register::R8,
    Register::R9,
    Register::R10,
    Register::R11,
    Register::RBX,
    Register::RBP,
    Register::R12,
    Register::R13,
    Register::R14,
];
/// Reaches the second part of the frame.
const FAR_FRAME: Register = Register::R15;
/// Bytes of the frame that one register reaches with one byte.
const NEAR_FRAME: u32 = 256 * 64;
/// Constants that one register reaches with one byte.
const NEAR_CONSTANTS: u32 = 256;
/// Most buffers of a program.
pub const MOST_BUFFERS: usize = BUFFERS.len();
/// Buffers whose registers a caller does not want back.
const FREE_BUFFERS: usize = 6;

/// On the stack: the row of the block that runs, the first row, and where rows end.
const CURRENT_ROW: Place = Place::at(Register::RSP, 0);
const FIRST_ROW: Place = Place::at(Register::RSP, 8);
const LAST_ROW: Place = Place::at(Register::RSP, 16);

/// A place in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    base: Register,
    index: Register,
    displacement: i64,
    is_broadcast: bool,
}

impl Place {
    /// So many bytes into the frame.
    pub fn frame(bytes: u32) -> Self {
        match bytes.checked_sub(NEAR_FRAME) {
            None => Self::at(Register::RDI, i64::from(bytes) - FRAME_BIAS),
            Some(bytes) => Self::at(FAR_FRAME, i64::from(bytes) - FRAME_BIAS),
        }
    }
    /// So many bytes into the frame, and as many more as [`Emitter::chunk_offset`] computed.
    pub fn frame_with_offset(bytes: u32) -> Self {
        Self { index: Register::RAX, ..Self::frame(bytes) }
    }
    /// Constants from this one on, one to a lane.
    pub fn vector_of_constants(number: u32) -> Self {
        Self::at(Register::RSI, i64::from(number) * 4 - POOL_BIAS)
    }
    /// So many bytes into a buffer.
    pub fn buffer(binding: u32, bytes: i64) -> Self {
        Self::at(BUFFERS[binding as usize], bytes)
    }
    /// One number there, in every lane.
    pub fn broadcast(self) -> Self {
        Self { is_broadcast: true, ..self }
    }

    const fn at(base: Register, displacement: i64) -> Self {
        Self { base, index: Register::None, displacement, is_broadcast: false }
    }

    fn operand(self) -> MemoryOperand {
        let size = u32::from(self.displacement != 0);
        MemoryOperand::new(self.base, self.index, 1, self.displacement, size, self.is_broadcast, Register::None)
    }
}

/// Where an operand is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum From {
    Register(u8),
    Memory(Place),
}

/// A jump whose target is not known yet.
#[derive(Clone, Copy, Debug)]
pub struct Jump(usize);

/// Writes machine code.
pub struct Emitter {
    encoder: Encoder,
    /// Bytes so far.
    length: usize,
    nbuffer: usize,
    /// Jumps and where they lead.
    landed: Vec<(Jump, usize)>,
    /// Where the piece begins that is being written.
    piece: usize,
}

pub fn zmm(number: u8) -> Register {
    Register::ZMM0 + u32::from(number)
}

pub fn mask(number: u8) -> Register {
    Register::K0 + u32::from(number)
}

impl Emitter {
    /// Begins a routine that takes in RDI and RSI where rows of pointers begin and end: frame, constants and buffers of each block.
    pub fn new(nbuffer: usize) -> Self {
        let mut this = Self { encoder: Encoder::new(64), length: 0, nbuffer, landed: vec![], piece: 0 };
        for kept in
            BUFFERS[FREE_BUFFERS..].iter().copied().chain([FAR_FRAME, Register::RSI, Register::RDI, Register::RDI])
        {
            this.put(Instruction::with1(Code::Push_r64, kept));
        }
        this.begin_piece();
        this
    }

    /// Begins what each block runs through before the next one does.
    pub fn begin_piece(&mut self) {
        self.piece = self.length;
        self.put(Instruction::with2(Code::Mov_r64_rm64, Register::RDI, CURRENT_ROW.operand()));
        let pointers = [Register::RSI].into_iter().chain(BUFFERS[..self.nbuffer].iter().copied());
        for (k, register) in pointers.enumerate() {
            let from = MemoryOperand::with_base_displ(Register::RDI, 8 * (k as i64 + 1));
            self.put(Instruction::with2(Code::Mov_r64_rm64, register, from));
        }
        for (register, window) in BUFFERS[self.nbuffer..].iter().zip(1..) {
            let from = MemoryOperand::with_base_displ(Register::RSI, window * i64::from(4 * NEAR_CONSTANTS));
            self.put(Instruction::with2(Code::Lea_r64_m, *register, from));
        }
        self.put(Instruction::with2(Code::Mov_r64_rm64, Register::RDI, MemoryOperand::with_base(Register::RDI)));
        let far = MemoryOperand::with_base_displ(Register::RDI, i64::from(NEAR_FRAME));
        self.put(Instruction::with2(Code::Lea_r64_m, FAR_FRAME, far));
    }

    /// Lets the next block run through the piece, if there is one; then the first block is next.
    pub fn end_piece(&mut self) {
        let row = 8 * (2 + self.nbuffer as i32);
        self.put(Instruction::with2(Code::Mov_r64_rm64, Register::RAX, CURRENT_ROW.operand()));
        self.put(Instruction::with2(Code::Add_rm64_imm32, Register::RAX, row));
        self.put(Instruction::with2(Code::Mov_rm64_r64, CURRENT_ROW.operand(), Register::RAX));
        self.put(Instruction::with2(Code::Cmp_r64_rm64, Register::RAX, LAST_ROW.operand()));
        self.put(Instruction::with_branch(Code::Jb_rel32_64, self.piece as u64));
        self.put(Instruction::with2(Code::Mov_r64_rm64, Register::RAX, FIRST_ROW.operand()));
        self.put(Instruction::with2(Code::Mov_rm64_r64, CURRENT_ROW.operand(), Register::RAX));
    }

    /// Ends the routine.
    pub fn finish(mut self) -> Vec<u8> {
        self.end_piece();
        self.put(Ok(Instruction::with(Code::VEX_Vzeroupper)));
        self.put(Instruction::with2(Code::Add_rm64_imm32, Register::RSP, 24));
        for &kept in BUFFERS[FREE_BUFFERS..].iter().chain([&FAR_FRAME]).rev() {
            self.put(Instruction::with1(Code::Pop_r64, kept));
        }
        self.put(Ok(Instruction::with(Code::Retnq)));
        let mut bytes = self.encoder.take_buffer();
        for (Jump(end), target) in self.landed {
            let distance = i32::try_from(target - end).expect("a routine is shorter than 2 GiB");
            bytes[end - 4..end].copy_from_slice(&distance.to_le_bytes());
        }
        bytes
    }

    fn put(&mut self, instruction: Result<Instruction, iced_x86::IcedError>) {
        let instruction = instruction.expect("operands fit the instruction");
        self.encode(&instruction);
    }

    fn encode(&mut self, instruction: &Instruction) {
        let encoded = self.encoder.encode(instruction, self.length as u64);
        self.length += encoded.expect("the instruction exists in 64-bit mode");
    }

    /// Where a constant is, the same in every lane. Registers that no buffer needs reach those farther on: a byte in place of four, in code
    /// that is read from memory as fast as it can be.
    pub fn constant(&self, number: u32) -> Place {
        let (window, place) = (number / NEAR_CONSTANTS, number % NEAR_CONSTANTS);
        let spare = BUFFERS[self.nbuffer..].get((window as usize).wrapping_sub(1));
        match spare {
            Some(&base) => Place::at(base, i64::from(place) * 4 - POOL_BIAS).broadcast(),
            None => Place::vector_of_constants(number).broadcast(),
        }
    }

    // --- vectors ---

    pub fn one(&mut self, code: Code, to: u8, a: From) {
        self.put(match a {
            From::Register(a) => Instruction::with2(code, zmm(to), zmm(a)),
            From::Memory(a) => Instruction::with2(code, zmm(to), a.operand()),
        });
    }

    pub fn one_by(&mut self, code: Code, to: u8, a: From, by: u32) {
        self.put(match a {
            From::Register(a) => Instruction::with3(code, zmm(to), zmm(a), by),
            From::Memory(a) => Instruction::with3(code, zmm(to), a.operand(), by),
        });
    }

    pub fn two(&mut self, code: Code, to: u8, a: u8, b: From) {
        self.put(match b {
            From::Register(b) => Instruction::with3(code, zmm(to), zmm(a), zmm(b)),
            From::Memory(b) => Instruction::with3(code, zmm(to), zmm(a), b.operand()),
        });
    }

    pub fn load(&mut self, to: u8, from: Place) {
        let code =
            if from.is_broadcast { Code::EVEX_Vbroadcastss_zmm_k1z_xmmm32 } else { Code::EVEX_Vmovups_zmm_k1z_zmmm512 };
        // A broadcast is the instruction itself here.
        let from = Place { is_broadcast: false, ..from };
        self.put(Instruction::with2(code, zmm(to), from.operand()));
    }

    pub fn zero(&mut self, to: u8) {
        self.two(Code::EVEX_Vpxord_zmm_k1z_zmm_zmmm512b32, to, to, From::Register(to));
    }

    pub fn copy(&mut self, to: u8, from: u8) {
        self.put(Instruction::with2(Code::EVEX_Vmovaps_zmm_k1z_zmmm512, zmm(to), zmm(from)));
    }

    pub fn store(&mut self, to: Place, from: u8, only: Option<u8>) {
        let stored = Instruction::with2(Code::EVEX_Vmovups_zmmm512_k1z_zmm, to.operand(), zmm(from));
        let mut stored = stored.expect("operands fit the instruction");
        if let Some(only) = only {
            stored.set_op_mask(mask(only));
        }
        self.encode(&stored);
    }

    /// Where the mask is true `yes`, else `no`.
    pub fn blend(&mut self, to: u8, only: u8, no: u8, yes: From) {
        let code = Code::EVEX_Vblendmps_zmm_k1z_zmm_zmmm512b32;
        let blended = match yes {
            From::Register(yes) => Instruction::with3(code, zmm(to), zmm(no), zmm(yes)),
            From::Memory(yes) => Instruction::with3(code, zmm(to), zmm(no), yes.operand()),
        };
        let mut blended = blended.expect("operands fit the instruction");
        blended.set_op_mask(mask(only));
        self.encode(&blended);
    }

    /// What there is where the mask is true, else zero.
    pub fn keep(&mut self, to: u8, only: u8, from: From) {
        let code = match from {
            From::Memory(Place { is_broadcast: true, .. }) => Code::EVEX_Vbroadcastss_zmm_k1z_xmmm32,
            _ => Code::EVEX_Vmovups_zmm_k1z_zmmm512,
        };
        let kept = match from {
            From::Register(from) => Instruction::with2(code, zmm(to), zmm(from)),
            From::Memory(from) => Instruction::with2(code, zmm(to), Place { is_broadcast: false, ..from }.operand()),
        };
        let mut kept = kept.expect("operands fit the instruction");
        kept.set_op_mask(mask(only));
        kept.set_zeroing_masking(true);
        self.encode(&kept);
    }

    /// Reads from a buffer, or from constants, the words whose numbers are in `index`; `only` is used up.
    pub fn gather(&mut self, to: u8, base: Place, index: u8, only: u8) {
        self.put(Instruction::with3(Code::VEX_Kxnorw_kr_kr_kr, mask(only), mask(only), mask(only)));
        // The old content of the register is not waited for.
        self.zero(to);
        let size = u32::from(base.displacement != 0);
        let from = MemoryOperand::new(base.base, zmm(index), 4, base.displacement, size, false, Register::None);
        let gathered = Instruction::with2(Code::EVEX_Vgatherdps_zmm_k1_vm32z, zmm(to), from);
        let mut gathered = gathered.expect("operands fit the instruction");
        gathered.set_op_mask(mask(only));
        self.encode(&gathered);
    }

    // --- masks ---

    pub fn less(&mut self, to: u8, a: u8, b: From) {
        const LESS_QUIET: u32 = 0x11;
        let code = Code::EVEX_Vcmpps_kr_k1_zmm_zmmm512b32_imm8_sae;
        self.put(match b {
            From::Register(b) => Instruction::with4(code, mask(to), zmm(a), zmm(b), LESS_QUIET),
            From::Memory(b) => Instruction::with4(code, mask(to), zmm(a), b.operand(), LESS_QUIET),
        });
    }

    pub fn masks(&mut self, code: Code, to: u8, a: u8, b: u8) {
        self.put(Instruction::with3(code, mask(to), mask(a), mask(b)));
    }

    pub fn mask_not(&mut self, to: u8, a: u8) {
        self.put(Instruction::with2(Code::VEX_Knotw_kr_kr, mask(to), mask(a)));
    }

    pub fn load_mask(&mut self, to: u8, from: Place) {
        self.put(Instruction::with2(Code::VEX_Kmovw_kr_km16, mask(to), from.operand()));
    }

    pub fn copy_mask(&mut self, to: u8, from: u8) {
        self.put(Instruction::with2(Code::VEX_Kmovw_kr_km16, mask(to), mask(from)));
    }

    pub fn store_mask(&mut self, to: Place, from: u8) {
        self.put(Instruction::with2(Code::VEX_Kmovw_m16_kr, to.operand(), mask(from)));
    }

    // --- counting and jumping ---

    pub fn set_counter(&mut self, counter: Place, to: u32) {
        self.put(Instruction::with2(Code::Mov_rm32_imm32, counter.operand(), to));
    }

    /// Counts one up.
    pub fn count_up(&mut self, counter: Place) {
        self.put(Instruction::with2(Code::Add_rm32_imm32, counter.operand(), 1));
    }

    /// Jumps where a count is below a limit.
    pub fn jump_if_below(&mut self, counter: Place, limit: u32, back: usize) {
        self.put(Instruction::with2(Code::Cmp_rm32_imm32, counter.operand(), limit));
        self.put(Instruction::with_branch(Code::Jb_rel32_64, back as u64));
    }

    /// How far the chunk that a counter counts is from the first one, for [`Place::frame_with_offset`].
    pub fn chunk_offset(&mut self, counter: Place, bytes: u32) {
        self.put(Instruction::with3(Code::Imul_r32_rm32_imm32, Register::EAX, counter.operand(), bytes));
    }

    /// Looks whether a mask is true in some lane, for [`Emitter::jump_if_none`].
    pub fn test(&mut self, only: u8) {
        self.put(Instruction::with2(Code::VEX_Kortestw_kr_kr, mask(only), mask(only)));
    }

    pub fn jump_if_none(&mut self) -> Jump {
        self.put(Instruction::with_branch(Code::Je_rel32_64, self.length as u64));
        Jump(self.length)
    }

    /// Where the next instruction will be.
    pub fn here(&self) -> usize {
        self.length
    }

    /// Lets a jump lead to the next instruction.
    pub fn land(&mut self, jump: Jump) {
        self.landed.push((jump, self.length));
    }
}
