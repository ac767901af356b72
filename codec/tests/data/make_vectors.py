"""Writes pymodbus_vectors.csv: frames as pymodbus encodes them, with the fields that went in.

    pip install pymodbus==3.16.1
    python make_vectors.py

The tests read the file; they need neither Python nor pymodbus. Left out is the reply to diagnostic 4 (force listen only):
pymodbus can encode one without data, the standard says that there is none.
"""

import pathlib
import random

import pymodbus
from pymodbus.framer.ascii import FramerAscii
from pymodbus.framer.rtu import FramerRTU
from pymodbus.pdu import DecodePDU
from pymodbus.pdu import bit_message as bit
from pymodbus.pdu import diag_message as diag
from pymodbus.pdu import file_message as file
from pymodbus.pdu import mei_message as mei
from pymodbus.pdu import other_message as other
from pymodbus.pdu import register_message as reg
from pymodbus.pdu.exceptionresponse import ExceptionResponse

UNITS = [0, 1, 17, 247]
rng = random.Random(20260101)
rows = []


def add(direction, pdu, **fields):
    """One row: the frame in both modes, and the fields as text."""
    payload = bytes([pdu.function_code]) + pdu.encode()
    unit = UNITS[len(rows) % len(UNITS)]
    server = direction == "request"
    rtu = FramerRTU(DecodePDU(server)).encode(payload, unit, 0)
    ascii_frame = FramerAscii(DecodePDU(server)).encode(payload, unit, 0)
    assert ascii_frame.endswith(b"\r\n")
    text = ";".join(f"{name}={value}" for name, value in fields.items())
    ascii_text = ascii_frame[:-2].decode("ascii")
    rows.append(f"{pdu.function_code:02X},{direction},{unit},{rtu.hex().upper()},{ascii_text},{text}")


def request(pdu, **fields):
    add("request", pdu, **fields)


def response(pdu, **fields):
    add("response", pdu, **fields)


def bits(count):
    return [rng.random() < 0.5 for _ in range(count)]


def words(count):
    return [rng.choice([0, 1, 0x7FFF, 0x8000, 0xFFFF, rng.randrange(0x10000)]) for _ in range(count)]


def bit_text(values):
    return "".join("1" if value else "0" for value in values)


def word_text(values):
    return " ".join(str(value) for value in values)


def word_bytes(values):
    return b"".join(value.to_bytes(2, "big") for value in values)


def reads_of_bits():
    asks = [bit.ReadCoilsRequest, bit.ReadDiscreteInputsRequest]
    answers = [bit.ReadCoilsResponse, bit.ReadDiscreteInputsResponse]
    for ask, answer in zip(asks, answers):
        for address, count in [(0, 1), (0x13, 0x13), (0x0300, 0x0101), (65535, 1), (1000, 1999), (0, 2000)]:
            request(ask(address=address, count=count), address=address, quantity=count)
        for count in [1, 7, 8, 9, 19, 22, 1992, 1999, 2000]:
            values = bits(count)
            response(answer(bits=values), bits=bit_text(values))


def reads_of_registers():
    asks = [reg.ReadHoldingRegistersRequest, reg.ReadInputRegistersRequest]
    answers = [reg.ReadHoldingRegistersResponse, reg.ReadInputRegistersResponse]
    for ask, answer in zip(asks, answers):
        for address, count in [(0, 1), (0x6B, 3), (65535, 1), (0x0400, 2), (65411, 125)]:
            request(ask(address=address, count=count), address=address, quantity=count)
        for count in [1, 2, 3, 124, 125]:
            values = words(count)
            response(answer(registers=values), values=word_text(values))


def single_writes():
    for address in [0, 0xAC, 65535]:
        for on in [True, False]:
            request(bit.WriteSingleCoilRequest(address=address, bits=[on]), address=address, on=int(on))
            response(bit.WriteSingleCoilResponse(address=address, bits=[on]), address=address, on=int(on))
        for value in [0, 3, 0xFF00, 0xFFFF]:
            request(reg.WriteSingleRegisterRequest(address=address, registers=[value]), address=address, value=value)
            response(reg.WriteSingleRegisterResponse(address=address, registers=[value]), address=address, value=value)


def multiple_writes():
    for address, count in [(0, 1), (0x13, 10), (65535, 1), (20, 8), (20, 9), (7, 1967), (0, 1968)]:
        values = bits(count)
        request(bit.WriteMultipleCoilsRequest(address=address, bits=values), address=address, bits=bit_text(values))
        response(bit.WriteMultipleCoilsResponse(address=address, count=count), address=address, quantity=count)
    for address, count in [(0, 1), (1, 2), (65535, 1), (100, 122), (0, 123)]:
        values = words(count)
        ask = reg.WriteMultipleRegistersRequest(address=address, registers=values)
        request(ask, address=address, values=word_text(values))
        response(reg.WriteMultipleRegistersResponse(address=address, count=count), address=address, quantity=count)
    for read, count, write, written in [(3, 6, 14, 3), (0, 1, 0, 1), (65535, 125, 65535, 121), (0x0A00, 124, 1, 120)]:
        values = words(written)
        ask = reg.ReadWriteMultipleRegistersRequest(
            read_address=read, read_count=count, write_address=write, write_registers=values
        )
        request(ask, read_address=read, read_quantity=count, write_address=write, values=word_text(values))
        values = words(count)
        response(reg.ReadWriteMultipleRegistersResponse(registers=values), values=word_text(values))
    for address, and_mask, or_mask in [(4, 0xF2, 0x25), (0, 0xFFFF, 0), (65535, 0, 0xFFFF)]:
        masks = {"address": address, "and_mask": and_mask, "or_mask": or_mask}
        request(reg.MaskWriteRegisterRequest(**masks), **masks)
        response(reg.MaskWriteRegisterResponse(**masks), **masks)


def line_diagnostics():
    request(other.ReadExceptionStatusRequest())
    for status in [0, 0x6D, 0xFF]:
        answer = other.ReadExceptionStatusResponse()
        answer.status = status
        response(answer, status=status)
    for data in [b"", b"\xa5\x37", b"\x01\x02\x03", bytes(rng.randrange(256) for _ in range(250))]:
        request(diag.ReturnQueryDataRequest(message=data), sub_function=0, data=data.hex())
        response(diag.ReturnQueryDataResponse(message=data), sub_function=0, data=data.hex())
    pairs = [
        (diag.RestartCommunicationsOptionRequest, diag.RestartCommunicationsOptionResponse, [0, 0xFF00]),
        (diag.ReturnDiagnosticRegisterRequest, diag.ReturnDiagnosticRegisterResponse, [0]),
        (diag.ChangeAsciiInputDelimiterRequest, diag.ChangeAsciiInputDelimiterResponse, [0x0A00, 0x2100]),
        (diag.ForceListenOnlyModeRequest, None, [0]),
        (diag.ClearCountersRequest, diag.ClearCountersResponse, [0]),
        (diag.ReturnBusMessageCountRequest, diag.ReturnBusMessageCountResponse, [0]),
        (diag.ReturnBusCommunicationErrorCountRequest, diag.ReturnBusCommunicationErrorCountResponse, [0]),
        (diag.ReturnBusExceptionErrorCountRequest, diag.ReturnBusExceptionErrorCountResponse, [0]),
        (diag.ReturnDeviceMessageCountRequest, diag.ReturnDeviceMessageCountResponse, [0]),
        (diag.ReturnDeviceNoResponseCountRequest, diag.ReturnDeviceNoResponseCountResponse, [0]),
        (diag.ReturnDeviceNAKCountRequest, diag.ReturnDeviceNAKCountResponse, [0]),
        (diag.ReturnDeviceBusyCountRequest, diag.ReturnDeviceBusyCountResponse, [0]),
        (diag.ReturnDeviceBusCharacterOverrunCountRequest, diag.ReturnDeviceBusCharacterOverrunCountResponse, [0]),
        (diag.ReturnIopOverrunCountRequest, diag.ReturnIopOverrunCountResponse, [0]),
        (diag.ClearOverrunCountRequest, diag.ClearOverrunCountResponse, [0]),
        (diag.GetClearModbusPlusRequest, diag.GetClearModbusPlusResponse, [3, 4]),
    ]
    for ask, answer, data in pairs:
        code = ask.sub_function_code
        for value in data:
            request(ask(message=value), sub_function=code, data=f"{value:04x}")
        for value in [*data, 1, 0xFFFF] if answer else []:
            response(answer(message=value), sub_function=code, data=f"{value:04x}")


def events():
    request(other.GetCommEventCounterRequest())
    request(other.GetCommEventLogRequest())
    for ready in [True, False]:
        status = 0 if ready else 0xFFFF
        for count in [0, 0x0108, 0xFFFF]:
            answer = other.GetCommEventCounterResponse(count=count, status=ready)
            response(answer, status=status, event_count=count)
        for number in [0, 1, 2, 63, 64]:
            log = [rng.randrange(256) for _ in range(number)]
            answer = other.GetCommEventLogResponse(status=ready, event_count=0x0108, message_count=0x0121, events=log)
            response(answer, status=status, event_count=0x0108, message_count=0x0121, events=bytes(log).hex())


def identification():
    request(other.ReportDeviceIdRequest())
    for running in [True, False]:
        for identifier in [b"\x11", b"Pymodbus", bytes(rng.randrange(256) for _ in range(250))]:
            data = identifier + (b"\xff" if running else b"\x00")
            response(other.ReportDeviceIdResponse(identifier=identifier, status=running), data=data.hex())
    for code in [1, 2, 3, 4]:
        for object_id in [0, 2, 0x80, 0xFF]:
            request(mei.ReadDeviceInformationRequest(read_code=code, object_id=object_id), code=code, object=object_id)
    objects = [
        {},
        {0: b"Company"},
        {0: b"Company identification", 1: b"Product code XX", 2: b"V2.11"},
        {3: b"", 0x80: b"\x00\xff"},
        # The last does not fit: more follows.
        {0: b"A" * 100, 1: b"B" * 100, 2: b"C" * 100},
        {5: b"D" * 244},
    ]
    for code in [1, 2, 3, 4]:
        for information in objects:
            answer = mei.ReadDeviceInformationResponse(read_code=code, information=information)
            answer.encode()
            sent = list(information.items())[: answer.number_of_objects]
            answer.number_of_objects, answer.space_left = 0, 253 - 6
            fields = {
                "code": code,
                "conformity": answer.conformity,
                "more": int(answer.more_follows),
                "next": answer.next_object_id,
                "objects": " ".join(f"{number}:{value.hex()}" for number, value in sent),
            }
            response(answer, **fields)


def files():
    groups = [[(4, 1, 2), (3, 9, 2)], [(1, 0, 1)], [(65535, 9999, 124)], [(7, number, 1) for number in range(35)]]
    for group in groups:
        ranges = [file.FileRecord(file_number=f, record_number=r, record_length=2 * n) for f, r, n in group]
        request(file.ReadFileRecordRequest(records=ranges), records=" ".join(f"{f}:{r}:{n}" for f, r, n in group))
        contents = [words(n) for _, _, n in group]
        answer = file.ReadFileRecordResponse(
            records=[file.FileRecord(record_data=word_bytes(values)) for values in contents]
        )
        response(answer, contents="/".join(word_text(values) for values in contents))
    for group in [[(4, 7, 3)], [(1, 0, 1)], [(65535, 9999, 122)], [(2, number, 2) for number in range(22)]]:
        written = [(f, r, words(n)) for f, r, n in group]
        records = [file.FileRecord(file_number=f, record_number=r, record_data=word_bytes(v)) for f, r, v in written]
        text = "/".join(f"{f}:{r}:{word_text(v)}" for f, r, v in written)
        request(file.WriteFileRecordRequest(records=records), written=text)
        response(file.WriteFileRecordResponse(records=records), written=text)


def queues():
    for address in [0, 0x04DE, 65535]:
        request(file.ReadFifoQueueRequest(address=address), address=address)
    for count in [0, 1, 2, 30, 31]:
        values = words(count)
        response(file.ReadFifoQueueResponse(values=values), values=word_text(values))


def exceptions():
    for function in [*range(1, 9), 0x0B, 0x0C, 0x0F, 0x10, 0x11, 0x14, 0x15, 0x16, 0x17, 0x18, 0x2B, 0x41, 0x7F]:
        for code in [1, 2, 3, 4, 5, 6, 8, 10, 11, 0x7E]:
            response(ExceptionResponse(function, code), exception=code)


reads_of_bits()
reads_of_registers()
single_writes()
multiple_writes()
line_diagnostics()
events()
identification()
files()
queues()
exceptions()

HEAD = [
    f"# Made by make_vectors.py with pymodbus {pymodbus.__version__}. An ASCII frame ends with CR LF, left out here.",
    "function,direction,unit,rtu,ascii,fields",
]
target = pathlib.Path(__file__).with_name("pymodbus_vectors.csv")
target.write_text("\n".join(HEAD + rows) + "\n", encoding="ascii")
