(* What integrals, sums, products, limits and exponentials of matrices are: the answers of a certificate, and growth at oo.
   Section 9 of docs/certificates.md. *)

open Text
open Tree
open Value
open Goal
open Rules
open Language
open Calculus

let infinity = Sym "oo"
let has_name s t = Names.mem s (symbols t)
let put_one s t = put [ (s, t) ]
let inverse_of t = Pow (t, Num Q.minus_one)
let with_symbol (goal : goal) s range = { goal with box = (s, range) :: List.remove_assoc s goal.box }
let from_zero = { anything with low = Some zero }

let is_infinite t =
  let found = equal t infinity || equal t (negate infinity) in
  if (not found) && has_name "oo" t then refuse "an end with oo inside";
  found

(* A tree is 0 by exact algebra, as it is without a proof, or at all points of the goal. *)
let prove_vanishing proof goal plain tree =
  match proof with Null -> shown "the terms differ" (Algebra.vanishes plain) | proof -> prove (premise goal tree Equal) proof

(* Signs: by balls, or the next one of the list with its proof *)

let sign_of_number goal signs c =
  match if has_symbols c then None else finite_ball no_symbols c with
  | Some x when Ball.is_above x -> 1
  | Some x when Ball.is_below x -> -1
  | _ -> (
      match !signs with
      | List [ sign; proof ] :: rest ->
          signs := rest;
          let sign = get_sign "signs" sign in
          prove (premise goal (signed sign c) Above) proof;
          sign
      | _ -> refuse "expected a sign with its proof")

(* (d, c): tree/w^d goes to c for w to oo; it is only bounded where c is nothing. *)
let rec grow sign w t =
  let go = grow sign w in
  let half = Q.of_ints 1 2 in
  if not (has_name w t) then (Q.zero, Some t)
  else
    match t with
    | Sym _ -> (Q.one, Some one)
    | Sum l ->
        let parts = List.map go (List.filter (fun t -> not (equal t zero)) l) in
        let top = List.fold_left (fun d (e, _) -> Q.max d e) (fst (List.hd parts)) parts in
        let first = List.filter_map (fun (d, c) -> if Q.equal d top then Some c else None) parts in
        (top, if List.mem None first then None else Some (sum' (List.filter_map Fun.id first)))
    | Prod l ->
        let parts = List.map go l in
        let known = List.filter_map snd parts in
        let total = List.fold_left (fun d (e, _) -> Q.add d e) Q.zero parts in
        (total, if List.length known < List.length parts then None else Some (product' known))
    | Pow (b, e) -> (
        match !constant e with
        | None -> go (apply "exp" (Prod [ e; apply "log" b ]))
        | Some q ->
            let d, c = go b in
            if (not (is_whole q)) || Q.sign q <= 0 then
              (match c with
              | Some c when sign c = 1 || is_whole q -> ()
              | _ -> refuse "a power that may have no value");
            (Q.mul d q, Option.map (fun c -> Pow (c, Num q)) c))
    | Fun ("sqrt", [ u ]) -> go (Pow (u, Num half))
    | Fun (("tan" | "cot" | "sec" | "csc" | "sinh" | "cosh") as f, [ u ]) ->
        let meaning =
          match f with
          | "tan" -> "sin(x)/cos(x)"
          | "cot" -> "cos(x)/sin(x)"
          | "sec" -> "1/cos(x)"
          | "csc" -> "1/sin(x)"
          | "sinh" -> "(exp(x) - exp(-x))/2"
          | _ -> "(exp(x) + exp(-x))/2"
        in
        go (put_one "x" u (read_tree meaning))
    | Fun (f, [ u ]) -> grow_function sign f (go u)
    | _ -> refuse "no growth is known"

and grow_function sign f (d, c) =
  let known () = match c with Some c -> c | None -> refuse "no growth is known" in
  match (f, Q.sign d) with
  | "abs", _ -> (d, Option.map (apply "abs") c)
  | "log", s ->
      if sign (known ()) <> 1 then refuse "a logarithm that may have no value";
      if s = 0 then (Q.zero, Some (apply "log" (known ()))) else (Q.of_ints 1 1000, None)
  | ("exp" | "cos"), -1 -> (Q.zero, Some one)
  | ("sin" | "atan" | "tanh"), -1 -> (d, c)
  | "erf", -1 -> (d, Option.map (fun c -> Prod [ number 2; Pow (Pi, Num (Q.of_ints (-1) 2)); c ]) c)
  | ("exp" | "cos" | "sin" | "atan" | "tanh" | "erf"), 0 -> (Q.zero, Option.map (apply f) c)
  | ("sin" | "cos"), _ -> (Q.zero, None)
  | "exp", _ -> if sign (known ()) = -1 then (Q.of_int (-1_000_000_000), None) else refuse "an exponential that may grow"
  | ("atan" | "tanh" | "erf"), _ ->
      let s = number (sign (known ())) in
      (Q.zero, Some (product' [ s; (if f = "atan" then half_pi else one) ]))
  | _ -> refuse "no growth is known"

let limit_at_infinity sign w t =
  match grow sign w t with
  | d, Some c when Q.sign d = 0 -> c
  | d, _ when Q.sign d < 0 -> zero
  | _ -> refuse "no limit is known"

let use_all signs = if !signs <> [] then refuse "a sign too many"

(* One piece of an integral, from c to d; where a limit is asked, w runs to oo. *)
let integrate_piece q goal value (c, d) =
  match get_keys "piece" [ "antiderivative"; "limits"; "continuous"; "smooth"; "equal"; "signs" ] value with
  | [ f; limits; continuous; smooth; same; signs ] ->
      let f = get_tree "antiderivative" f and name = q.variable and signs = ref (get_list "signs" signs) in
      let x = Sym name in
      let open_low, open_high =
        match List.map (fun v -> get_integer "limits" 0 1 v = 1) (get_list "limits" limits) with
        | [ a; b ] -> (a, b)
        | _ -> refuse "limits: expected two"
      in
      let low_far = is_infinite c and high_far = is_infinite d in
      if low_far && high_far then refuse "expected a cut between -oo and oo";
      if (low_far && not open_low) || (high_far && not open_high) then refuse "expected a limit at oo";
      let w = inverse_of x in
      let path, range, low_way, high_way =
        if high_far then begin
          if not (equal d infinity) then refuse "a range that ends at -oo";
          (sum' [ c; x ], { from_zero with open_low }, sum' [ c; w ], x)
        end
        else if low_far then begin
          if not (equal c (negate infinity)) then refuse "a range that begins at oo";
          (subtract d x, { from_zero with open_low = open_high }, negate x, distance d w)
        end
        else
          let across = distance d c in
          let range = { from_zero with high = Some one; open_low; open_high } in
          let step = Prod [ across; w ] in
          (sum' [ c; Prod [ across; x ] ], range, sum' [ c; step ], distance d step)
      in
      let whole = with_symbol goal name range in
      let inside = with_symbol goal name { range with open_low = true; open_high = true } in
      let slope = derive name f and on_path = put_one name path in
      defined ~level:1 whole [ on_path f ] continuous;
      defined ~level:2 inside (List.map on_path (f :: slope :: (q.terms @ q.needs))) smooth;
      let difference = subtract slope (List.hd q.terms) in
      prove_vanishing same inside difference (on_path difference);
      let value_at is_limit way place =
        if is_limit then limit_at_infinity (sign_of_number goal signs) name (put_one name way f) else put_one name place f
      in
      let low = value_at open_low low_way c in
      let high = value_at open_high high_way d in
      use_all signs;
      subtract high low
  | _ -> assert false

let rec pairwise = function a :: (b :: _ as l) -> (a, b) :: pairwise l | _ -> []

let answer_integral q goal value =
  match get_keys "answer" [ "cuts"; "pieces" ] value with
  | [ cuts; pieces ] ->
      let places = (q.low :: List.map (get_tree "cuts") (get_list "cuts" cuts)) @ [ q.high ] in
      if List.exists (has_name q.variable) places then refuse "the variable in a cut";
      let pieces = get_list "pieces" pieces and ends = pairwise places in
      same_length "pieces" ends pieces;
      Sum (zero :: List.map2 (integrate_piece q goal) pieces ends)
  | _ -> assert false

let answer_terms q goal =
  let row k = let at t = check_exponents_inside [ (q.variable, k) ] t; put_one q.variable k t in List.map at (q.terms @ q.needs) in
  let rows = List.map row (list_whole q.low q.high) in
  defined goal (List.concat rows) (List []);
  join_terms q.kind (List.map List.hd rows)

let answer_sum q (goal : goal) value =
  if value = Text "terms" then answer_terms q goal else
  match get_keys "answer" [ "telescoper"; "defined"; "equal"; "start"; "count"; "signs" ] value with
  | [ g; conditions; same; start; count; signs ] ->
      let g = get_tree "telescoper" g and name = q.variable and signs = ref (get_list "signs" signs) in
      let k = Sym name and f = List.hd q.terms and is_sum = q.kind = "sum" in
      let is_whole_end t = is_integral goal.box [] t in
      if not (is_whole_end q.low) then refuse "expected whole ends";
      let path = sum' [ q.low; k ] and next = put_one name (Sum [ k; one ]) g and first = put_one name q.low g in
      let inside = with_symbol goal name { from_zero with integer = true } in
      let inside, last =
        if is_infinite q.high then begin
          if not (equal q.high infinity && count = Null) then refuse "a sum to -oo";
          (inside, limit_at_infinity (sign_of_number goal signs) name g)
        end
        else begin
          if not (is_whole_end q.high) then refuse "expected whole ends";
          let length = subtract q.high q.low in
          prove (premise goal (Sum [ length; one ]) AtLeast) count;
          ({ inside with given = goal.given @ [ subtract length k ] }, put_one name (Sum [ q.high; one ]) g)
        end
      in
      use_all signs;
      let on_path = put_one name path in
      defined inside (List.map on_path (g :: next :: f :: q.needs)) conditions;
      let difference = subtract next (if is_sum then Sum [ g; f ] else Prod [ g; f ]) in
      prove_vanishing same inside difference (on_path difference);
      let needed = if is_sum then first else inverse_of first in
      defined goal [ needed ] start;
      if is_sum then subtract last first else Prod [ last; needed ]
  | _ -> assert false

let answer_limit q goal value =
  let name = q.variable in
  let y = Sym name and far = is_infinite q.low in
  let way = if far && not (equal q.low infinity) then negate y else y in
  let typed = List.map (put_one name way) (q.terms @ q.needs) in
  let places = List.filter (fun (_, t) -> has_name name t) (conditions 0 typed) in
  let is_short = match value with Object [ ("signs", _) ] -> true | _ -> false in
  let keys = (if is_short then [] else [ "top"; "bottom"; "order"; "defined"; "zeros"; "pole"; "around" ]) @ [ "signs" ] in
  let values = get_keys "answer" keys value in
  let signs = ref (get_list "signs" (List.nth values (List.length values - 1))) in
  let sign = sign_of_number goal signs in
  let check_far (r, t) =
    match snd (grow sign name t) with
    | Some c when (let s = sign c in s = 1 || r = Unequal) -> ()
    | _ -> refuse "it may have no value"
  in
  if far then List.iter check_far places;
  match values with
  | [ _ ] ->
      if not far then refuse "expected oo";
      let found = limit_at_infinity sign name (List.hd typed) in
      use_all signs;
      found
  | [ top; bottom; order; wanted; zeros; pole; around; _ ] ->
      use_all signs;
      let n = get_integer "order" 0 8 order and top = get_tree "top" top and bottom = get_tree "bottom" bottom in
      let a = if far then zero else q.low in
      let f = if far then put_one name (inverse_of y) (List.hd typed) else List.hd typed in
      shown "the quotient is another one" (Algebra.vanishes (subtract f (Prod [ top; inverse_of bottom ])));
      let at = put_one name a in
      let derivative t k = at (List.fold_left (fun t _ -> derive name t) t (List.init k Fun.id)) in
      let places = if far then [] else places in
      let orders = List.map (get_integer "around" 0 8) (get_list "around" around) in
      same_length "around" places orders;
      let near_one (r, t) k =
        if r <> Unequal && k <> 0 then refuse "a sign on both sides";
        (derivative t k, if r = Unequal then Unequal else Above)
      in
      let near = List.map2 near_one places orders in
      let above = derivative top n and below = derivative bottom n in
      let smoothness t = List.map (fun c -> at (existing c)) (conditions 2 [ t ]) in
      let analytic =
        List.map at (top :: bottom :: List.map snd places) @ List.map fst near @ (above :: below :: smoothness top) @ smoothness bottom
      in
      defined ~level:2 goal analytic wanted;
      let goals = List.map (fun (t, r) -> premise goal t r) in
      prove_each "pole" (goals (near @ [ (below, Unequal) ])) (get_list "pole" pole);
      let zeros_below k = [ (derivative top k, Equal); (derivative bottom k, Equal) ] in
      prove_each "zeros" (goals (List.concat_map zeros_below (List.init n Fun.id))) (get_list "zeros" zeros);
      Prod [ above; inverse_of below ]
  | _ -> assert false

(* The entries of X(1), where dX/ds = A X and X(0) is the unit matrix *)
let answer_expm q goal value =
  match get_keys "answer" [ "rows"; "smooth"; "equal"; "start" ] value with
  | [ rows; smooth; same; start ] ->
      let x = List.map (fun row -> List.map (get_tree "rows") (get_list "rows" row)) (get_list "rows" rows) in
      let n = List.length x and s = q.variable in
      if n * n <> List.length q.terms || List.exists (fun row -> List.length row <> n) x then refuse "rows: another size";
      let whole = with_symbol goal s { from_zero with high = Some one } in
      defined ~level:2 whole (List.concat x) smooth;
      let entry i j = List.nth (List.nth x i) j and same = get_list "equal" same and start = get_list "start" start in
      same_length "equal" q.terms same;
      same_length "start" q.terms start;
      let check_entry k slope first =
        let i = k / n and j = k mod n in
        let image = sum_of_parts (List.init n (fun l -> Prod [ List.nth q.terms ((n * i) + l); entry l j ])) in
        let change = subtract (derive s (entry i j)) image in
        prove_vanishing slope whole change change;
        let beginning = subtract (put_one s zero (entry i j)) (if i = j then one else zero) in
        prove_vanishing first goal beginning beginning
      in
      List.iteri (fun k slope -> check_entry k slope (List.nth start k)) same;
      List.concat_map (List.map (put_one s one)) x
  | _ -> assert false

(* The goal for all values of the variable of a question around *)
let bind (goal : goal) q =
  let number t = if is_infinite t || has_symbols t then None else finite_ball no_symbols t in
  let ends =
    match (number q.low, number q.high) with
    | Some a, Some b when Ball.is_above (Ball.less b a) -> (Some q.low, Some q.high)
    | None, Some _ -> (None, Some q.high)
    | Some _, None -> (Some q.low, None)
    | _ -> (None, None)
  in
  let range = { anything with low = fst ends; high = snd ends; integer = q.kind = "sum" || q.kind = "product" } in
  with_symbol goal q.variable (if q.kind = "limit" then anything else range)

(* The values of all questions, which take their places in what the case says. [point] are the numbers of a counterexample. *)
let settle context said answers point =
  let bound = List.map (fun q -> q.variable) context.questions in
  if List.exists (fun s -> List.mem_assoc s context.box) ("oo" :: bound) then refuse "a name that is in use";
  if context.fractions <> [] then refuse "a whole part beside a question";
  let typed = said @ List.concat_map (fun q -> (q.low :: q.high :: q.terms) @ q.needs) context.questions in
  let is_free t = not (is_asked t || List.exists (fun s -> has_name s t) bound) in
  let exists = List.map existing (List.filter (fun (_, t) -> is_free t) (conditions 0 typed)) in
  List.iter (say context) exists;
  let plain = List.filter (fun t -> not (is_asked t)) in
  let whole = { (alone zero Equal) with box = context.box; exists; given = plain context.given; zeros = plain context.zeros } in
  let settle_one values question =
    let q = change_question (put values) question in
    let q, goal =
      match point with
      | None -> (q, whole)
      | Some numbers ->
          let at t = check_exponents_inside numbers t; put numbers t in
          (change_question at q, alone zero Equal)
    in
    let goal = List.fold_left bind goal q.within in
    match !answers with
    | [] -> refuse "%s without an answer" q.kind
    | entry :: rest ->
        answers := rest;
        let one_value =
          match q.kind with
          | "integral" -> answer_integral
          | "limit" -> answer_limit
          | "expm" -> (fun _ _ _ -> assert false)
          | _ -> answer_sum
        in
        let n = List.length q.terms in
        let rec root k = if k * k >= n then k else root (k + 1) in
        let place k = Printf.sprintf "%s %d %d" q.value (k / root 1) (k mod root 1) in
        if q.kind = "expm" then List.mapi (fun k t -> (place k, t)) (answer_expm q goal entry) @ values
        else (q.value, one_value q goal entry) :: values
  in
  put (List.fold_left settle_one [] context.questions)
