"""Makes turnwright-sans.otf from Noto Sans CJK SC (SIL Open Font License 1.1, Debian package fonts-noto-cjk).

    pip install fonttools
    python3 make_font.py /usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc

Kept: ASCII, Latin-1, the signs of a drawing, every character of data/report-texts.json, and characters that
file names of turned parts are made of. Run it again after adding a Chinese text; a test says when.
"""
import json
import pathlib
import sys
import tomllib

from fontTools import subset
from fontTools.ttLib import TTCollection

HERE = pathlib.Path(__file__).parent
TEXTS = HERE / "../../../data/report-texts.json"
# Of the words of the command line, those that stand in pictures too.
WORDS = HERE / "../../../data/texts.toml"
IN_PICTURES = ("diff-", "cutting-", "target-", "list-comma", "colon", "pass-")
FAMILY = "Turnwright Sans"
SIGNS = "⌀▷∠−·→←↑↓°±×…–—“”‘’、。，：；（）"
PART_NAMES = (
    "零件图号名称轴套盘螺母栓丝杆钉法兰端盖齿轮毛坯棒料外圆内孔面槽倒角圆弧锥度球头粗精车镗钻铰切断割退刀"
    "第一二三四五六七八九十件次道序夹装正反左右前后上下大小长短高低新旧版本练习题测试示例比赛考试实训作业加工"
    "数控床程编号主子调用宏程循环铜铁钢铝不锈活塞阶梯手柄葫芦酒杯国际象棋兵卒车马王后宝塔陀螺传动销芯管接头"
    "阀体堵塞支承座衬环隔垫圈弹簧油泵气缸转子定电机壳连杆曲凸偏心双中空薄壁细深多单复合公司年月日甲乙丙丁"
)

texts = json.loads(TEXTS.read_text(encoding="utf-8"))
characters = {chr(c) for c in [*range(0x20, 0x7F), *range(0xA0, 0x100)]} | set(SIGNS) | set(PART_NAMES)
for entry in texts.values():
    characters |= set(entry["en"]) | set(entry["zh"])
for key, entry in tomllib.loads(WORDS.read_text(encoding="utf-8")).items():
    if key.startswith(IN_PICTURES):
        characters |= set(entry["en"]) | set(entry["zh"])

collection = TTCollection(sys.argv[1])
font = next(f for f in collection.fonts if f["name"].getDebugName(4) == "Noto Sans CJK SC")
# The font draws the empty set exactly as drawings draw a diameter; it has no diameter sign of its own.
for table in font["cmap"].tables:
    if table.isUnicode() and 0x2205 in table.cmap:
        table.cmap[0x2300] = table.cmap[0x2205]

options = subset.Options()
options.layout_features = ["kern"]
options.name_IDs = [0, 1, 2, 3, 4, 5, 6, 7, 13, 14]
options.hinting = False
options.drop_tables += ["VORG", "vhea", "vmtx", "DSIG", "BASE"]
subsetter = subset.Subsetter(options)
subsetter.populate(text="".join(characters))
subsetter.subset(font)
for record in font["name"].names:
    renamed = {1: FAMILY, 3: FAMILY, 4: FAMILY, 6: FAMILY.replace(" ", "")}.get(record.nameID)
    if renamed:
        record.string = renamed
top = font["CFF "].cff
top.fontNames[0] = FAMILY.replace(" ", "")
font.recalcTimestamp = False
out = HERE / "turnwright-sans.otf"
font.save(out)
missing = characters - {chr(c) for c in font.getBestCmap()} - {"\u00ad"}
print(out, out.stat().st_size, "bytes,", len(font.getBestCmap()), "characters, missing:", sorted(missing))
