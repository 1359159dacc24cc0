"""What an image is made of, as a CycloneDX document: the same for the same image."""

import json
import uuid

from quiesce.base.extras import extra
from quiesce.firmware.image import Image

COMPILER = "arm-none-eabi-gcc"
REGISTERS, REGISTERS_VERSION = "stm32f4", "0.16.0"  # a crate, hal/stm32f4/registers.toml


def parts_list(image: Image, compiler: str, sha256: str) -> str:
    """JSON of CycloneDX 1.6."""
    with extra("firmware", "a list of parts"):
        from cyclonedx.model import HashAlgorithm, HashType, Property
        from cyclonedx.model.bom import Bom
        from cyclonedx.model.component import Component, ComponentType
        from cyclonedx.model.license import DisjunctiveLicense, LicenseExpression
        from cyclonedx.output.json import JsonV1Dot6
    firmware = Component(
        name=f"quiesce-{image.board}", version=image.version_text, type=ComponentType.FIRMWARE,
        bom_ref="firmware", licenses=[DisjunctiveLicense(id="Apache-2.0")],
        hashes=[HashType(alg=HashAlgorithm.SHA_256, content=sha256)],
        properties=[
            Property(name="quiesce:param_layout", value=f"0x{image.param_layout:08X}"),
            *(
                Property(name=f"quiesce:table:{one.kind}", value=f"crc32 0x{one.crc:08X}")
                for one in image.tables
            ),
        ],
    )  # fmt: skip
    registers = Component(
        name=REGISTERS, version=REGISTERS_VERSION, type=ComponentType.DATA, bom_ref="registers",
        description="register addresses and masks",
        licenses=[LicenseExpression("MIT OR Apache-2.0")],
    )  # fmt: skip
    runtime = Component(
        name="libgcc and newlib", version=compiler, type=ComponentType.LIBRARY, bom_ref="runtime",
        description=f"of {COMPILER}: 64-bit division, memory copies",
    )  # fmt: skip
    bom = Bom(components=[registers, runtime], serial_number=uuid.uuid5(uuid.NAMESPACE_OID, sha256))
    bom.metadata.component = firmware
    bom.register_dependency(firmware, [registers, runtime])
    return without_time(JsonV1Dot6(bom).output_as_string())


def without_time(text: str) -> str:
    document = json.loads(text)
    del document["metadata"]["timestamp"]
    return json.dumps(document, indent=2, sort_keys=True) + "\n"
