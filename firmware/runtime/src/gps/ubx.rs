//! UBX: NAV-PVT, the one message with position, accuracy and velocity of one epoch.

use math::GeoPoint;
use ublox::nav_pvt::common::NavPvtFlags;
use ublox::nav_pvt::proto23::NavPvtRef;
use ublox::proto23::{PacketRef, Proto23};
use ublox::{FixedBuffer, GnssFixType, Parser, UbxPacket};

use super::Solution;

/// NAV-PVT takes 100 bytes with its frame. Longer messages do not fit and are skipped.
const BUFFER_BYTES: usize = 136;

/// First byte of every message.
const SYNC: u8 = 0xb5;

pub(super) struct Decoder {
    parser: Parser<FixedBuffer<BUFFER_BYTES>, Proto23>,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { parser: Parser::new(FixedBuffer::new()) }
    }
}

impl Decoder {
    pub(super) fn push(&mut self, byte: u8) -> Option<Solution> {
        if self.parser.is_buffer_empty() && byte != SYNC {
            return None;
        }
        let chunk = [byte];
        let mut packets = self.parser.consume_ubx(&chunk);
        let mut latest = None;
        // A byte that exposes a false start can complete several messages behind it. What is
        // damaged is dropped.
        while let Some(packet) = packets.next() {
            if let Ok(UbxPacket::Proto23(PacketRef::NavPvt(pvt))) = packet {
                latest = Some(solution(&pvt));
            }
        }
        latest
    }
}

fn solution(pvt: &NavPvtRef<'_>) -> Solution {
    let place = GeoPoint { lat_e7: pvt.latitude_raw(), lon_e7: pvt.longitude_raw() };
    // Dead reckoning alone and time alone are no fixes.
    let has_position = matches!(
        pvt.fix_type(),
        GnssFixType::Fix2D | GnssFixType::Fix3D | GnssFixType::GPSPlusDeadReckoning
    );
    let is_valid = pvt.flags().contains(NavPvtFlags::GPS_FIX_OK)
        && has_position
        && !pvt.flags3().invalid_llh()
        && place.is_valid();
    Solution {
        is_valid,
        place,
        accuracy_mm: pvt.horizontal_accuracy_raw(),
        velocity_mmps: Some([pvt.vel_east_raw(), pvt.vel_north_raw()]),
    }
}
