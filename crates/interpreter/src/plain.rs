//! The short way of most blocks: a path word by word, with nothing else in force.
//!
//! In: a block of a sequence number, G00 to G03, axis words, `R`, `I`, `K` and a feed. Out: the same as
//! [`block`](crate::block) would make of it; whatever else a block may be or meet goes there. Whether something
//! in force wants to see every block is asked once, behind a block that could have changed it, and not in each.

use turnwright_syntax::{Block, Decimal, Value, Word};

use crate::Environment;
use crate::axes::Plane;
use crate::block::Call;
use crate::functions::FunctionId;
use crate::machine::Core;
use crate::report::Alarm;

/// Axis words.
pub(crate) const AXES: u32 = Block::bit(b'X') | Block::bit(b'Z') | Block::bit(b'U') | Block::bit(b'W');
/// Centre and radius of an arc.
pub(crate) const BEND: u32 = Block::bit(b'I') | Block::bit(b'K') | Block::bit(b'R');
pub(crate) const PLAIN: u32 = AXES | BEND | Block::bit(b'G') | Block::bit(b'N') | Block::bit(b'F');

/// Whether a block has words that no plain one has.
#[inline]
pub(crate) const fn has_other_words(block: &Block) -> bool {
    block.present() & !PLAIN != 0
}

/// What a plain block comes to, whatever its numbers are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain {
    /// The function and the code of its G word.
    code: Option<(FunctionId, u16)>,
}

impl Core {
    /// Sorts a block that is nothing but a path; `None` for any other.
    #[inline]
    pub(crate) fn plain(&self, block: &Block) -> Option<Plain> {
        let present = block.present();
        if has_other_words(block)
            || present & AXES == 0
            || block.has_comma
            || block.words.len() as u32 != present.count_ones()
        {
            return None;
        }
        let code = match block.word(b'G') {
            None => None,
            Some(Word { value: Value::Number(number), .. }) => Some(self.plain_code(*number)?),
            Some(_) => return None,
        };
        Some(Plain { code })
    }

    /// Executes a plain block; false when its function is none of a path or no axis is left, and nothing was done.
    #[inline]
    pub(crate) fn execute_plain(
        &mut self,
        block: &Block,
        Plain { code }: Plain,
        environment: &mut dyn Environment,
    ) -> Result<bool, Alarm> {
        let function = code.map_or(self.modal.motion, |(id, _)| id).get();
        // The words of a kept block may have come to nothing since it was sorted.
        let has_axes = block.present() & AXES != 0;
        if !has_axes || function.path.is_none() || (block.present() & BEND != 0 && function.draws_lines) {
            return Ok(false);
        }
        if let Some(place) = block.place(b'N') {
            self.sequence_number(block, place)?;
        }
        if let Some((id, code)) = code {
            self.change_motion(id, code);
        }
        if let Some(word) = block.word(b'F') {
            self.feed_word(word, function)?;
        }
        let (code, word) = (self.modal.motion_code, block.word(b'G'));
        function.run(self, &mut Call { block, environment, code, word })?;
        self.is_plain = self.corner.is_none();
        Ok(true)
    }

    /// The function of a G word written without sign, point or surplus digits.
    #[inline]
    pub(crate) fn plain_code(&self, number: Decimal) -> Option<(FunctionId, u16)> {
        if number.scale != 0 || number.is_negative || !(0..1_000).contains(&number.digits) {
            return None;
        }
        let code = number.digits as u16 * 10;
        self.dispatch.function(code).map(|id| (id, code))
    }

    /// Whether nothing in force looks at blocks of a path.
    pub(crate) fn has_plain_state(&self) -> bool {
        let calls = &self.macros.calls;
        self.has_started
            && !self.is_over
            && !self.expects_program_number
            && !self.stops_once
            && self.thread_blocks == 0
            && self.data_list.is_none()
            && self.corner.is_none()
            && self.compensation.is_none()
            && self.untaken.is_none()
            && self.macros.modal_calls.is_empty()
            && !(calls.has_preparatory() || calls.has_auxiliary() || calls.has_tools())
            && self.axes.plane == Plane::Zx
            && !self.axes.is_virtual()
            && self.transform.rotation.is_none()
            && !self.is_in_figure()
    }
}
